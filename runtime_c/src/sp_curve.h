/* Smooth curves of the normalised depth u.
 *
 * u is 0 at the lowest trained position and 1 at the last node. Each curve has a value and a slope
 * at equally spaced nodes from 0 to 1, is a parabola between two nodes, and straight beyond the
 * last one. A curve whose slopes are all >= 0 never falls. */
#ifndef SP_CURVE_H
#define SP_CURVE_H

#include <stdint.h>

#include "sp_real.h"

typedef struct {
    uint32_t interval;
    sp_real fraction; /* of the interval, 0 .. 1; above 1 beyond the last node */
} sp_curve_position;

/* Find the interval that holds u. Below 0 curves are constant; the last interval extends beyond the
 * last node. */
static inline sp_curve_position sp_curve_locate(sp_real u, uint32_t n_intervals)
{
    const sp_real n_per_u = (sp_real)(n_intervals > 1u ? n_intervals - 1u : 1u);
    const sp_real last = (sp_real)(n_intervals - 1u);
    const sp_real steps = u > (sp_real)0 ? u * n_per_u : (sp_real)0;
    const uint32_t interval = steps < last ? (uint32_t)steps : n_intervals - 1u;
    const sp_curve_position place = {interval, steps - (sp_real)interval};
    return place;
}

/* Evaluate n_curves curves. nodes: [n_intervals + 1][2][n_curves], values and slopes per interval;
 * the last slope repeats. values: [n_curves]. */
static inline void sp_curve(const sp_real *nodes, uint32_t n_curves, sp_curve_position place,
                            sp_real *values)
{
    const sp_real *value = nodes + place.interval * 2 * n_curves;
    const sp_real *slope = value + n_curves;
    const sp_real *next = slope + 2 * n_curves;
    const sp_real half = (sp_real)0.5 * place.fraction;
    for (uint32_t i = 0; i < n_curves; i++) {
        values[i] = value[i] + place.fraction * (slope[i] + half * (next[i] - slope[i]));
    }
}

#endif
