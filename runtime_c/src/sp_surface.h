/* The surface of an object that lets go: it recovers more slowly than a tool can leave.
 *
 * A model that is pressed along the tool's fraction would pull. An object does not: from where its
 * force is 0 on, the tool has left it, and its surface comes back by itself. So the model is moved
 * to
 *
 *     u = max(tool, surface),   surface = where its force is 0
 *
 * and gives no force while the tool is above. From tick to tick the surface comes back as far as
 * the force of the last tick allows at the stiffest that each interval of the depth can be: the
 * model does not pull on the fraction, and what is left of the force moves it in the next tick. No
 * work is done, and stored energy falls (docs/explanation/model.md). */
#ifndef SP_SURFACE_H
#define SP_SURFACE_H

#include <stdint.h>

#include "sp_curve.h"

typedef struct {
    sp_real u;       /* of the model in the last tick, as in sp_curve.h */
    sp_real force_n; /* which it had there */
} sp_surface_state;

/* Where the surface comes back to from `from` under force_n. stiffest: [n_intervals], N a interval.
 */
static inline sp_real sp_surface_recovered_u(const sp_real *stiffest, uint32_t n_intervals,
                                             sp_real from, sp_real force_n)
{
    sp_curve_position place = sp_curve_locate(from, n_intervals);
    sp_real remaining_n = force_n;
    sp_real unload_n = stiffest[place.interval] * place.fraction;
    while (place.interval > 0 && remaining_n > unload_n) {
        remaining_n -= unload_n;
        place.interval--;
        place.fraction = (sp_real)1;
        unload_n = stiffest[place.interval];
    }
    const sp_real fraction = place.fraction - remaining_n / stiffest[place.interval];
    const sp_real end = (sp_real)place.interval + (fraction > (sp_real)0 ? fraction : (sp_real)0);
    const sp_real n_per_u = (sp_real)(n_intervals > 1u ? n_intervals - 1u : 1u);
    return end / n_per_u;
}

/* Where the model is while the tool is at u; NaN passes. */
static inline sp_real sp_surface_model_u(const sp_real *stiffest, uint32_t n_intervals,
                                         const sp_surface_state *state, sp_real u)
{
    if (!(u < state->u)) {
        return u;
    }
    if (!(state->force_n > (sp_real)0)) {
        return state->u;
    }
    const sp_real recovered_u =
        sp_surface_recovered_u(stiffest, n_intervals, state->u, state->force_n);
    const sp_real surface =
        recovered_u < state->u ? recovered_u : state->u; /* but for rounding, recovered_u */
    return u > surface ? u : surface;
}

#endif
