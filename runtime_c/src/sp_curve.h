/* Curves of the depth: smooth, and monotone.
 *
 * u is 0 at the lowest trained position, 1 at the last node. Each curve has a value and a slope at
 * equally spaced nodes from 0 to 1. It is a parabola between them, and straight beyond the last
 * one. With slopes >= 0 it never falls. */
#ifndef SP_CURVE_H
#define SP_CURVE_H

#include <stdint.h>

#include "sp_real.h"

typedef struct {
    uint32_t piece;
    sp_real way; /* from the start of the piece, 1 at its end; beyond 1 in the last piece */
} sp_curve_place;

/* Curves do not move below u = 0. n_pieces: those between nodes, and the one beyond. */
static inline sp_curve_place sp_curve_at(sp_real u, uint32_t n_pieces)
{
    const sp_real per_piece = (sp_real)(n_pieces > 1u ? n_pieces - 1u : 1u);
    const sp_real last = (sp_real)(n_pieces - 1u);
    const sp_real passed = u > (sp_real)0 ? u * per_piece : (sp_real)0;
    const uint32_t piece = passed < last ? (uint32_t)passed : n_pieces - 1u;
    const sp_curve_place place = {piece, passed - (sp_real)piece};
    return place;
}

/* nodes: [n_pieces + 1][2][n_curves], values and slopes a piece at each node; the last slope goes
 * on. values: [n_curves]. */
static inline void sp_curve(const sp_real *nodes, uint32_t n_curves, sp_curve_place place,
                            sp_real *values)
{
    const sp_real *value = nodes + place.piece * 2 * n_curves;
    const sp_real *slope = value + n_curves;
    const sp_real *next = slope + 2 * n_curves;
    const sp_real half = (sp_real)0.5 * place.way;
    for (uint32_t i = 0; i < n_curves; i++) {
        values[i] = value[i] + place.way * (slope[i] + half * (next[i] - slope[i]));
    }
}

#endif
