/* Hammerstein with branches whose time constant is above 1e5 ticks: in float they would stop
 * moving, so they are kept in double. They come last. See sp_hammerstein.h, sp_slow_poles.h. */
#ifndef SP_HAMMERSTEIN_SLOW_H
#define SP_HAMMERSTEIN_SLOW_H

#include "sp_hammerstein.h"

typedef struct {
    uint32_t n;
    const double *loss; /* [n] */
    double *held;       /* [n] */
} sp_hammerstein_slow;

/* Each has an input of its own: g now, `before` at the last tick; out: in the scene's type. */
static inline void sp_hammerstein_slow_poles(const sp_hammerstein_slow *slow, const sp_real *g,
                                             sp_real *before, sp_real *out)
{
    for (uint32_t i = 0; i < slow->n; i++) {
        const double h = slow->held[i];
        slow->held[i] = sp_flushed_double(h + ((double)(g[i] - before[i]) - slow->loss[i] * h));
        out[i] = (sp_real)slow->held[i];
        before[i] = g[i];
    }
}

/* As sp_hammerstein_step. */
static inline sp_real sp_hammerstein_step_slow(const sp_hammerstein_config *config,
                                               const sp_hammerstein_tables *tables,
                                               const sp_hammerstein_slow *slow, sp_real x,
                                               sp_real *before, sp_real *held, sp_real *play,
                                               sp_real *g)
{
    const sp_real u = (x - config->origin_m) * config->per_span;
    const sp_curve_place place = sp_curve_at(u, config->n_pieces);
    const uint32_t n_fast = config->n_branches - slow->n;
    sp_curve(tables->branches, config->degree, config->n_branches, place, g);
    sp_poles_apart(tables->loss, n_fast, g, before, held);
    sp_hammerstein_slow_poles(slow, g + n_fast, before + n_fast, held + n_fast);
    const sp_real still_n = sp_hammerstein_still(config, tables, u, place, play);
    return still_n + sp_hammerstein_held(held, config->n_branches);
}

#endif
