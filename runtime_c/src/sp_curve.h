/* Curves: weighted sums of a monotone basis of the depth, as the polynomials that they are.
 *
 * u is 0 at the lowest trained position and 1 at the maximum. The range is cut into pieces, in each
 * of which every curve is a polynomial in the way from the piece's start: ramps that saturate one
 * after the other give eight straight pieces, powers of u one cubic. So a sum over the basis costs
 * one polynomial, whatever the basis has. */
#ifndef SP_CURVE_H
#define SP_CURVE_H

#include <stdint.h>

#include "sp_real.h"

typedef struct {
    uint32_t piece;
    sp_real way; /* u - start of the piece */
} sp_curve_place;

/* Curves do not move below u = 0; the last piece goes on beyond u = 1. */
static inline sp_curve_place sp_curve_at(sp_real u, uint32_t n_pieces)
{
    const sp_real pieces = (sp_real)n_pieces;
    const sp_real v = u > (sp_real)0 ? u : (sp_real)0;
    const sp_real last = (sp_real)(n_pieces - 1);
    const sp_real passed = v * pieces;
    const sp_real found = passed < last ? passed : last;
    sp_curve_place place;
    place.piece = (uint32_t)found;
    place.way = v - (sp_real)place.piece / pieces;
    return place;
}

/* terms: [n_pieces][degree + 1][n_curves], highest power first; values: [n_curves]. */
static inline void sp_curve(const sp_real *terms, uint32_t degree, uint32_t n_curves,
                            sp_curve_place place, sp_real *values)
{
    const sp_real *term = terms + place.piece * (degree + 1) * n_curves;
    for (uint32_t i = 0; i < n_curves; i++) {
        sp_real value = term[i];
        for (uint32_t power = 1; power <= degree; power++) {
            value = value * place.way + term[power * n_curves + i];
        }
        values[i] = value;
    }
}

#endif
