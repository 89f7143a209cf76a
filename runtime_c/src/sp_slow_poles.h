/* Poles (sp_poles.h) with a time constant above 1e5 ticks. In float their states would stop moving:
 * a step is smaller than the rounding. So they are double whatever the scene's number type is. */
#ifndef SP_SLOW_POLES_H
#define SP_SLOW_POLES_H

#include <stdint.h>

#include "sp_number.h"

/* Advance poles that share one input: h[n] = h[n-1] - loss h[n-1] + rise. out: h in the scene's
 * type. */
static inline void sp_slow_poles(const double *loss, uint32_t n_poles, sp_real rise, double *h,
                                 sp_real *out)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        h[i] = sp_flush_denormal_double(h[i] + ((double)rise - loss[i] * h[i]));
        out[i] = (sp_real)h[i];
    }
}

/* Advance poles that have an input each: g now, `before` at the last tick. */
static inline void sp_slow_poles_separate(const double *loss, uint32_t n_poles, const sp_real *g,
                                          sp_real *before, double *h, sp_real *out)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        sp_slow_poles(loss + i, 1, g[i] - before[i], h + i, out + i);
        before[i] = g[i];
    }
}

#endif
