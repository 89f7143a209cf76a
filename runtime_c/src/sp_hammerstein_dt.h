/* Hammerstein over a measured time step: its poles are exact whatever dt is. See sp_hammerstein.h.
 */
#ifndef SP_HAMMERSTEIN_DT_H
#define SP_HAMMERSTEIN_DT_H

#include "sp_hammerstein.h"
#include "sp_measured.h"

/* One tick of dt_s at depth x, m; per_tau, per_gain: [n_branches], see sp_measured.h. */
static inline sp_real sp_hammerstein_step_dt(const sp_hammerstein_config *config,
                                             const sp_hammerstein_tables *tables,
                                             const sp_real *per_tau, const sp_real *per_gain,
                                             sp_real dt_s, sp_real x, sp_real *before,
                                             sp_real *held, sp_real *play, sp_real *g)
{
    const sp_real u = (x - config->origin_m) * config->per_span;
    const sp_curve_place place = sp_curve_at(u, config->n_pieces);
    sp_curve(tables->branches, config->degree, config->n_branches, place, g);
    sp_measured_apart(per_tau, per_gain, config->n_branches, dt_s, g, before, held);
    const sp_real still_n = sp_hammerstein_still(config, tables, u, place, play);
    return still_n + sp_hammerstein_held(held, config->n_branches);
}

#endif
