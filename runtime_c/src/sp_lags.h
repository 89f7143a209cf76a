/* Past positions in a ring of `length` samples: the newest one at `newest`, older ones after it. */
#ifndef SP_LAGS_H
#define SP_LAGS_H

#include <stdint.h>

#include "sp_real.h"

static inline void sp_lags_fill(sp_real *ring, uint32_t *newest, uint32_t length, sp_real x)
{
    for (uint32_t i = 0; i < length; i++) {
        ring[i] = x;
    }
    *newest = 0;
}

static inline void sp_lags_push(sp_real *ring, uint32_t *newest, uint32_t length, sp_real x)
{
    *newest = (*newest == 0 ? length : *newest) - 1;
    ring[*newest] = x;
}

/* Position `lag` samples ago; lag < length. */
static inline sp_real sp_lags_get(const sp_real *ring, uint32_t newest, uint32_t length,
                                  uint32_t lag)
{
    const uint32_t at = newest + lag;
    return ring[at < length ? at : at - length];
}

#endif
