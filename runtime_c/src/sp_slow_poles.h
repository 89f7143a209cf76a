/* Poles (sp_poles.h) with a time constant above 1e5 ticks. In float their states would stop moving:
 * a step is smaller than the rounding. So they are double whatever the scene's number type is. */
#ifndef SP_SLOW_POLES_H
#define SP_SLOW_POLES_H

#include <stdint.h>

#include "sp_number.h"

/* Advance relaxations that share one input by a tick, in double: h = h - loss h + rise. A slow
 * one loses less in a tick than float can tell. out: h in the scene's type. */
static inline void sp_slow_poles(const double *loss, uint32_t n_poles, sp_real rise, double *h,
                                 sp_real *out)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        h[i] = sp_flush_denormal_double(h[i] + ((double)rise - loss[i] * h[i]));
        out[i] = (sp_real)h[i];
    }
}

/* As above for branches that have an input each: g now, `before` at the last tick. */
static inline void sp_slow_poles_separate(const double *loss, uint32_t n_poles, const sp_real *g,
                                          sp_real *before, double *h, sp_real *out)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        sp_slow_poles(loss + i, 1, g[i] - before[i], h + i, out + i);
        before[i] = g[i];
    }
}

#endif
