/* Poles with a time constant above 1e5 ticks: in float their states would stop moving, so they
 * are kept in double whatever the scene's number type. See sp_poles.h. */
#ifndef SP_SLOW_POLES_H
#define SP_SLOW_POLES_H

#include <stdint.h>

#include "sp_number.h"

/* h[n] = h[n-1] - loss h[n-1] + rise, of the input g; out: h in the scene's type. */
static inline void sp_slow_poles(const double *loss, uint32_t n_poles, sp_real rise, double *h,
                                 sp_real *out)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        h[i] = sp_flush_denormal_double(h[i] + ((double)rise - loss[i] * h[i]));
        out[i] = (sp_real)h[i];
    }
}

/* Each has an input of its own: g now, `before` at the last tick. */
static inline void sp_slow_poles_separate(const double *loss, uint32_t n_poles, const sp_real *g,
                                          sp_real *before, double *h, sp_real *out)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        sp_slow_poles(loss + i, 1, g[i] - before[i], h + i, out + i);
        before[i] = g[i];
    }
}

#endif
