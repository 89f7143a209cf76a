/* Poles whose rate depends on the depth: soft tissue and elastomers relax faster or slower the
 * deeper they are pressed.
 *
 *     h' = g' - r(u) h,   h[n] = h[n-1] + d - loss(u) (h[n-1] + d/2),   d = g[n] - g[n-1]
 *
 * dissipates for every r(u) > 0 (loss 0 to 1), as h relaxes towards g at the middle of the step.
 * The loss is linear between the nodes of the curves (sp_curve.h). */
#ifndef SP_DEPTH_H
#define SP_DEPTH_H

#include <stdint.h>

#include "sp_curve.h"
#include "sp_number.h"

/* Advance Maxwell branches whose relaxation rate depends on depth, each with an input: its
 * elastic force g now, `before` at the last tick. loss: [n_intervals + 1][n_poles], at the
 * nodes; the last row repeats. */
static inline void sp_poles_by_depth(const sp_real *loss, uint32_t n_poles, sp_curve_position place,
                                     const sp_real *g, sp_real *before, sp_real *h)
{
    const sp_real *at = loss + place.interval * n_poles;
    for (uint32_t i = 0; i < n_poles; i++) {
        const sp_real loss_at_u = at[i] + place.fraction * (at[n_poles + i] - at[i]);
        const sp_real rise = g[i] - before[i];
        const sp_real branch_n = sp_clamp_state(h[i]);
        h[i] = sp_flush_denormal(branch_n + (rise - loss_at_u * (branch_n + (sp_real)0.5 * rise)));
        before[i] = g[i];
    }
}

/* As above with states in double (sp_slow_poles.h), for branches that relax by less than the
 * rounding of float in a tick. out: h in the scene's type. */
static inline void sp_slow_poles_by_depth(const sp_real *loss, uint32_t n_poles,
                                          sp_curve_position place, const sp_real *g,
                                          sp_real *before, double *h, sp_real *out)
{
    const sp_real *at = loss + place.interval * n_poles;
    for (uint32_t i = 0; i < n_poles; i++) {
        const double loss_at_u = (double)(at[i] + place.fraction * (at[n_poles + i] - at[i]));
        const double rise = (double)(g[i] - before[i]);
        const double branch_n = sp_clamp_state_double(h[i]);
        h[i] = sp_flush_denormal_double(branch_n + (rise - loss_at_u * (branch_n + 0.5 * rise)));
        out[i] = (sp_real)h[i];
        before[i] = g[i];
    }
}

#endif
