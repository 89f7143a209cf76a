/* The surface of an object that lets go: it recovers more slowly than a tool can leave.
 *
 * A model that is pressed along the tool's way would pull. An object does not: from where its force
 * is 0 on, the tool has left it, and its surface comes back by itself. So the model is moved to
 *
 *     u = max(tool, surface),   surface = where its force is 0
 *
 * and gives no force while the tool is above. From tick to tick the surface comes back as far as
 * the force of the last tick allows at the stiffest that each piece of the depth can be: the model
 * does not pull on the way, and what is left of the force moves it in the next tick. No work is
 * done, and stored energy falls (docs/explanation/model.md). */
#ifndef SP_SURFACE_H
#define SP_SURFACE_H

#include <stdint.h>

#include "sp_curve.h"

typedef struct {
    sp_real u;       /* of the model in the last tick, as in sp_curve.h */
    sp_real force_n; /* which it had there */
} sp_surface_state;

/* Where the surface comes back to from `from` under force_n. stiffest: [n_pieces], N a piece. */
static inline sp_real sp_surface_back(const sp_real *stiffest, uint32_t n_pieces, sp_real from,
                                      sp_real force_n)
{
    sp_curve_place place = sp_curve_at(from, n_pieces);
    sp_real left_n = force_n;
    sp_real takes_n = stiffest[place.piece] * place.way;
    while (place.piece > 0 && left_n > takes_n) {
        left_n -= takes_n;
        place.piece--;
        place.way = (sp_real)1;
        takes_n = stiffest[place.piece];
    }
    const sp_real way = place.way - left_n / stiffest[place.piece];
    const sp_real end = (sp_real)place.piece + (way > (sp_real)0 ? way : (sp_real)0);
    const sp_real per_piece = (sp_real)(n_pieces > 1u ? n_pieces - 1u : 1u);
    return end / per_piece;
}

/* Where the model is while the tool is at u; NaN passes. */
static inline sp_real sp_surface_at(const sp_real *stiffest, uint32_t n_pieces,
                                    const sp_surface_state *state, sp_real u)
{
    if (!(u < state->u)) {
        return u;
    }
    if (!(state->force_n > (sp_real)0)) {
        return state->u;
    }
    const sp_real found = sp_surface_back(stiffest, n_pieces, state->u, state->force_n);
    const sp_real surface = found < state->u ? found : state->u; /* but for rounding, found */
    return u > surface ? u : surface;
}

#endif
