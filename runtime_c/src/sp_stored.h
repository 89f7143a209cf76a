/* Stored energy of curves that never fall (sp_curve.h), in N pieces:
 *
 *     spring                                  G(u), the integral of its curve g
 *     branch that holds h = g(u) - z, stop    G(u) - G(y) - z (u - y),   g(y) = z
 *
 * which is G(u) + G*(z) - z u, G* the conjugate of G (Fenchel): never negative, and 0 at rest. Of a
 * branch y is found from z; of a stop it is the play. */
#ifndef SP_STORED_H
#define SP_STORED_H

#include <stdint.h>

#include "sp_hammerstein.h"
#include "sp_number.h"

/* Integral of a curve up to a place. curve: its column of n_curves in sp_curve's nodes; areas: the
 * same of [n_pieces][n_curves], up to each node. */
static inline sp_real sp_stored_area(const sp_real *areas, const sp_real *curve, uint32_t n_curves,
                                     sp_curve_place place)
{
    const sp_real *value = curve + place.piece * 2 * n_curves;
    const sp_real slope = value[n_curves];
    const sp_real bend = value[3 * n_curves] - slope;
    const sp_real way = place.way;
    const sp_real third = way * (sp_real)(1.0 / 3.0);
    const sp_real mean = value[0] + (sp_real)0.5 * way * (slope + third * bend);
    return areas[place.piece * n_curves] + way * mean;
}

/* Where a curve is z. Where it is flat there, and so any place as good, at a node. */
static inline sp_curve_place sp_stored_where(const sp_real *curve, uint32_t n_curves,
                                             uint32_t n_pieces, sp_real z)
{
    const uint32_t last = n_pieces - 1u;
    uint32_t piece = 0;
    while (piece < last && !(curve[(piece + 1) * 2 * n_curves] > z)) {
        piece++;
    }
    sp_curve_place place = {piece, (sp_real)0};
    const sp_real *value = curve + piece * 2 * n_curves;
    const sp_real slope = value[n_curves];
    const sp_real twice = (sp_real)2 * (z - value[0]);
    const sp_real square = slope * slope + (value[3 * n_curves] - slope) * twice;
    const sp_real sum = slope + (square > (sp_real)0 ? sp_sqrt(square) : (sp_real)0);
    if (twice > (sp_real)0 && sum > SP_SMALLEST) {
        place.way = sp_bounded(twice / sum);
    }
    return place;
}

/* Way from one place to another, in pieces. */
static inline sp_real sp_stored_way(sp_curve_place from, sp_curve_place to)
{
    return ((sp_real)to.piece - (sp_real)from.piece) + (to.way - from.way);
}

/* G(y) + z (u - y), with the y at which a curve is z: what a branch has lost since it was at z = 0.
 */
static inline sp_real sp_stored_lost(const sp_real *areas, const sp_real *curve, uint32_t n_curves,
                                     uint32_t n_pieces, sp_curve_place u, sp_real z)
{
    const sp_curve_place y = sp_stored_where(curve, n_curves, n_pieces, z);
    return sp_stored_area(areas, curve, n_curves, y) + z * sp_stored_way(y, u);
}

/* At most this share of what branches have relaxed is renewed at once. */
#define SP_STORED_RENEWED ((sp_real)0.25)

/* Of a whole model. areas: of spring, branches and stops, one after the other; g: the branches'
 * curves at `place`, where the model is; held, play: its state there. renewal: at most how much
 * more, a share renewed, as energy is convex in z: z less than that share. */
static inline sp_real sp_stored(const sp_hammerstein_config *config,
                                const sp_hammerstein_tables *tables, const sp_real *areas,
                                sp_curve_place place, const sp_real *g, const sp_real *held,
                                const sp_real *play, sp_real *renewal)
{
    const uint32_t pieces = config->n_pieces;
    const uint32_t n = config->n_branches;
    sp_real stored = sp_stored_area(areas, tables->spring, 1, place);
    sp_real takes = (sp_real)0;
    for (uint32_t i = 0; i < n; i++) {
        const sp_real *curve = tables->branches + i;
        const sp_real *its = areas + pieces + i;
        const sp_real z = g[i] - held[i];
        if (!(g[i] > (sp_real)0) && !(z > (sp_real)0)) {
            continue; /* at rest at the surface, and what fills a vector */
        }
        const sp_real less = ((sp_real)1 - SP_STORED_RENEWED) * z;
        const sp_real lost = sp_stored_lost(its, curve, n, pieces, place, z);
        stored += sp_stored_area(its, curve, n, place) - lost;
        takes += lost - sp_stored_lost(its, curve, n, pieces, place, less);
    }
    *renewal = takes / SP_STORED_RENEWED;
    for (uint32_t k = 0; k < config->n_stops; k++) {
        /* Its first half is part of the spring. */
        const sp_real *curve = tables->stops + k * (pieces + 1) * 2;
        const sp_curve_place y = sp_curve_at(play[k], pieces);
        const sp_real *its = areas + (1 + n + k) * pieces;
        sp_real z;
        sp_curve(curve, 1, y, &z);
        stored -= sp_stored_area(its, curve, 1, y) + z * sp_stored_way(y, place);
    }
    return stored;
}

#endif
