/* Window: the newest `length` samples, contiguous, newest first.
 *
 * Each sample is written twice, `length` apart, so that no tick moves the buffer. */
#ifndef SP_WINDOW_H
#define SP_WINDOW_H

#include <stdint.h>

#include "sp_real.h"

/* Fill `samples` (2 x length) with x: the object has rested there for a long time. */
static inline void sp_window_fill(sp_real *samples, uint32_t *newest, uint32_t length, sp_real x)
{
    for (uint32_t i = 0; i < 2 * length; i++) {
        samples[i] = x;
    }
    *newest = 0;
}

/* Add x to a window stored twice, so that `length` samples, newest first, are always in one
 * piece; returns where they begin. */
static inline const sp_real *sp_window_push(sp_real *samples, uint32_t *newest, uint32_t length,
                                            sp_real x)
{
    const uint32_t at = (*newest == 0 ? length : *newest) - 1;
    samples[at] = x;
    samples[at + length] = x;
    *newest = at;
    return samples + at;
}

#endif
