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
    uint32_t interval;
    sp_real
        fraction; /* from the start of the interval, 1 at its end; beyond 1 in the last interval */
} sp_curve_position;

/* Curves do not move below u = 0. n_intervals: those between nodes, and the one beyond. */
static inline sp_curve_position sp_curve_locate(sp_real u, uint32_t n_intervals)
{
    const sp_real n_per_u = (sp_real)(n_intervals > 1u ? n_intervals - 1u : 1u);
    const sp_real last = (sp_real)(n_intervals - 1u);
    const sp_real passed = u > (sp_real)0 ? u * n_per_u : (sp_real)0;
    const uint32_t interval = passed < last ? (uint32_t)passed : n_intervals - 1u;
    const sp_curve_position place = {interval, passed - (sp_real)interval};
    return place;
}

/* nodes: [n_intervals + 1][2][n_curves], values and slopes a interval at each node; the last slope
 * goes on. values: [n_curves]. */
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
