/* The same over a measured time step. See sp_hammerstein_dt.h, sp_hammerstein_slow.h. */
#ifndef SP_HAMMERSTEIN_SLOW_DT_H
#define SP_HAMMERSTEIN_SLOW_DT_H

#include "sp_hammerstein_slow.h"
#include "sp_measured.h"

/* One tick of dt_s at depth x, m; per_tau, per_gain: [n_branches], see sp_measured.h. */
static inline sp_real sp_hammerstein_step_slow_dt(const sp_hammerstein_config *config,
                                                  const sp_hammerstein_tables *tables,
                                                  const sp_hammerstein_slow *slow,
                                                  const sp_real *per_tau, const sp_real *per_gain,
                                                  sp_real dt_s, sp_real x, sp_real *before,
                                                  sp_real *held, sp_real *play, sp_real *g)
{
    const sp_real u = (x - config->origin_m) * config->per_span;
    const sp_curve_place place = sp_curve_at(u, config->n_pieces);
    const uint32_t n_fast = config->n_branches - slow->n;
    sp_curve(tables->branches, config->degree, config->n_branches, place, g);
    sp_measured_apart(per_tau, per_gain, n_fast, dt_s, g, before, held);
    for (uint32_t i = 0; i < slow->n; i++) {
        const uint32_t k = n_fast + i;
        sp_measured_slow(per_tau + k, per_gain + k, 1, dt_s, g[k] - before[k], slow->held + i,
                         held + k);
        before[k] = g[k];
    }
    const sp_real still_n = sp_hammerstein_still(config, tables, u, place, play);
    return still_n + sp_hammerstein_held(held, config->n_branches);
}

#endif
