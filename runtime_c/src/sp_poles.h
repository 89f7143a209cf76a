/* Poles: h' = g' - h/tau for many tau at once, with g linear within a step (exact at any rate):
 *
 *     h[n] = exp(-dt/tau) h[n-1] + gain (g[n] - g[n-1])
 *
 * loss = 1 - exp(-dt/tau). The gain, tau/dt (1 - exp(-dt/tau)), is folded into the weights of h or
 * into g. At rest h is 0, so that a start in equilibrium needs no history. */
#ifndef SP_POLES_H
#define SP_POLES_H

#include <stdint.h>

#include "sp_number.h"

static inline sp_real sp_poles_step(sp_real h, sp_real loss, sp_real rise)
{
    return sp_flush_denormal(h + (rise - loss * h));
}

/* Advance poles that share one input, which rose by `rise` since the last tick. */
static inline void sp_poles_shared(const sp_real *loss, uint32_t n_poles, sp_real rise, sp_real *h)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        h[i] = sp_poles_step(h[i], loss[i], rise);
    }
}

/* Advance Maxwell branches that have an input each: its elastic force g now, `before` at the
 * last tick. */
static inline void sp_poles_separate(const sp_real *loss, uint32_t n_poles, const sp_real *g,
                                     sp_real *before, sp_real *h)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        h[i] = sp_poles_step(h[i], loss[i], g[i] - before[i]);
        before[i] = g[i];
    }
}

#endif
