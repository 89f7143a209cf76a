/* Surface of an object that recovers more slowly than the tool leaves it.
 *
 * If the model followed the tool, it would pull the tool back. A real object lets go: where its
 * force reaches 0 the tool leaves it, and the surface recovers by itself. So the model sees
 *
 *     u = max(tool, surface),   surface = the depth at which the model's force is 0
 *
 * and renders no force while the tool is above the surface. Each tick the surface rises until the
 * last force is used up, unloaded at the upper bound of the slope: the model never pulls, and what
 * it still pushes raises the surface in the next tick. That does no work on the tool, and the
 * stored energy falls (docs/explanation/model.md). */
#ifndef SP_SURFACE_H
#define SP_SURFACE_H

#include <stdint.h>

#include "sp_curve.h"

typedef struct {
    sp_real u;       /* normalised depth of the model in the last tick (sp_curve.h) */
    sp_real force_n; /* its force there */
} sp_surface_state;

/* Depth to which a surface that the tool has left recovers in this tick, driven by the force
 * force_n that is left in the branches. max_slope_n: [n_intervals], upper bound of the force
 * gained in each interval, N. */
static inline sp_real sp_surface_recovered_u(const sp_real *max_slope_n, uint32_t n_intervals,
                                             sp_real from_u, sp_real force_n)
{
    sp_curve_position place = sp_curve_locate(from_u, n_intervals);
    sp_real remaining_n = force_n;
    sp_real unload_n = max_slope_n[place.interval] * place.fraction;
    while (place.interval > 0 && remaining_n > unload_n) {
        remaining_n -= unload_n;
        place.interval--;
        place.fraction = (sp_real)1;
        unload_n = max_slope_n[place.interval];
    }
    const sp_real fraction = place.fraction - remaining_n / max_slope_n[place.interval];
    const sp_real end = (sp_real)place.interval + (fraction > (sp_real)0 ? fraction : (sp_real)0);
    const sp_real n_per_u = (sp_real)(n_intervals > 1u ? n_intervals - 1u : 1u);
    return end / n_per_u;
}

/* Depth that the model sees while the tool is at u: that of the tool, or of the surface where
 * the tool leaves faster than the surface recovers. NaN passes. */
static inline sp_real sp_surface_model_u(const sp_real *max_slope_n, uint32_t n_intervals,
                                         const sp_surface_state *state, sp_real u)
{
    if (!(u < state->u)) {
        return u;
    }
    if (!(state->force_n > (sp_real)0)) {
        return state->u;
    }
    const sp_real recovered_u =
        sp_surface_recovered_u(max_slope_n, n_intervals, state->u, state->force_n);
    const sp_real surface =
        recovered_u < state->u ? recovered_u : state->u; /* rounding may raise recovered_u */
    return u > surface ? u : surface;
}

#endif
