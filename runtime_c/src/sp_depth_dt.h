/* Poles whose rate depends on the depth, over a measured time step. See sp_depth.h, sp_measured.h.
 */
#ifndef SP_DEPTH_DT_H
#define SP_DEPTH_DT_H

#include "sp_depth.h"
#include "sp_measured.h"

/* rates: [n_pieces + 1][n_poles], 1/s, at the nodes; the last row repeats. Loss of pole i. */
static inline sp_real sp_depth_measured_loss(const sp_real *rates, uint32_t n_poles, uint32_t i,
                                             sp_curve_place place, sp_real dt_s)
{
    const sp_real *rate = rates + place.piece * n_poles + i;
    const sp_real begins = dt_s * rate[0];
    const sp_real ends = dt_s * rate[n_poles];
    const sp_real at_begin = sp_measured_loss(begins);
    const sp_real at_end = sp_measured_loss(ends);
    return at_begin + place.way * (at_end - at_begin);
}

static inline void sp_depth_poles_dt(const sp_real *rates, uint32_t n_poles, sp_curve_place place,
                                     sp_real dt_s, const sp_real *g, sp_real *before, sp_real *h)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        const sp_real lost = sp_depth_measured_loss(rates, n_poles, i, place, dt_s);
        const sp_real rise = g[i] - before[i];
        h[i] = sp_flushed(sp_bounded(h[i] + (rise - lost * (h[i] + (sp_real)0.5 * rise))));
        before[i] = g[i];
    }
}

/* The same kept in double; out: in the scene's type. */
static inline void sp_depth_slow_poles_dt(const sp_real *rates, uint32_t n_poles,
                                          sp_curve_place place, sp_real dt_s, const sp_real *g,
                                          sp_real *before, double *h, sp_real *out)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        const double lost = (double)sp_depth_measured_loss(rates, n_poles, i, place, dt_s);
        const double rise = (double)(g[i] - before[i]);
        h[i] = sp_flushed_double(sp_bounded_double(h[i] + (rise - lost * (h[i] + 0.5 * rise))));
        out[i] = (sp_real)h[i];
        before[i] = g[i];
    }
}

#endif
