/* Hammerstein model: a spring, Maxwell branches and stop operators. Each has a curve of the depth
 * that never falls:
 *
 *     force = bias + spring(u) + sum over branches of highpass(g_i(u)) + sum over stops
 *
 * Every weight is non-negative and every pole real, so that the force is passive: a closed
 * press takes at least as much energy as it returns. A stop is P(u) - P(play); P(u) is part of the
 * spring's curve. Within a tick the branches (sp_poles.h, sp_poles_by_depth.h) advance after their
 * curves are read at u, and before their forces are summed here. */
#ifndef SP_HAMMERSTEIN_H
#define SP_HAMMERSTEIN_H

#include <stdint.h>

#include "sp_curve.h"
#include "sp_stops.h"

/* On targets with vector units n_branches is a multiple of it. */
enum { SP_HAMMERSTEIN_LANES = 4 };

typedef struct {
    sp_real origin_m;
    sp_real u_per_m; /* 1/m */
    sp_real bias_n;
    uint32_t n_intervals;
    uint32_t n_branches;
    uint32_t n_stops;
} sp_hammerstein_config;

/* Constant tables of the scene. Curves as in sp_curve.h, N. */
typedef struct {
    const sp_real *spring;   /* one curve */
    const sp_real *branches; /* n_branches curves */
    const sp_real *stops;    /* one curve for each stop */
    const sp_real *radius;   /* [n_stops], in u */
} sp_hammerstein_tables;

/* Normalised depth of x, m. */
static inline sp_real sp_hammerstein_u(const sp_hammerstein_config *config, sp_real x)
{
    return (x - config->origin_m) * config->u_per_m;
}

/* Set the state of an object that has rested at u for a long time: every branch has relaxed.
 * before, held: [n_branches]; play: [n_stops]. */
static inline void sp_hammerstein_rest(const sp_hammerstein_config *config,
                                       const sp_hammerstein_tables *tables, sp_real u,
                                       sp_real *before, sp_real *held, sp_real *play)
{
    sp_curve(tables->branches, config->n_branches, sp_curve_locate(u, config->n_intervals), before);
    for (uint32_t i = 0; i < config->n_branches; i++) {
        held[i] = (sp_real)0;
    }
    for (uint32_t k = 0; k < config->n_stops; k++) {
        play[k] = u;
    }
}

/* Rate-independent force at u: spring, stops and bias, N. Updates the stops' plays. */
static inline sp_real sp_hammerstein_static_force(const sp_hammerstein_config *config,
                                                  const sp_hammerstein_tables *tables, sp_real u,
                                                  sp_curve_position place, sp_real *play)
{
    sp_real static_n;
    sp_curve(tables->spring, 1, place, &static_n);
    static_n += config->bias_n;
    for (uint32_t k = 0; k < config->n_stops; k++) {
        const sp_real *stop = tables->stops + k * (config->n_intervals + 1) * 2;
        sp_real stop_n;
        play[k] = sp_stops_play(play[k], u, tables->radius[k]);
        sp_curve(stop, 1, sp_curve_locate(play[k], config->n_intervals), &stop_n);
        static_n -= stop_n;
    }
    return static_n;
}

/* Sum of the branch forces: four partial sums in one fixed order, so that bits do not depend on
 * vector units. */
static inline sp_real sp_hammerstein_branch_sum(const sp_real *held, uint32_t n_branches)
{
    sp_real sum[SP_HAMMERSTEIN_LANES] = {0};
    const uint32_t whole = n_branches - n_branches % SP_HAMMERSTEIN_LANES;
    for (uint32_t i = 0; i < whole; i += SP_HAMMERSTEIN_LANES) {
#pragma GCC unroll 4
        for (uint32_t k = 0; k < SP_HAMMERSTEIN_LANES; k++) {
            sum[k] += held[i + k];
        }
    }
#pragma GCC unroll 4
    for (uint32_t i = whole; i < n_branches; i++) {
        sum[i - whole] += held[i];
    }
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/* Force at u, N: branch forces `held` of this tick, spring, stops and bias. */
static inline sp_real sp_hammerstein_force(const sp_hammerstein_config *config,
                                           const sp_hammerstein_tables *tables, sp_real u,
                                           sp_curve_position place, const sp_real *held,
                                           sp_real *play)
{
    const sp_real static_n = sp_hammerstein_static_force(config, tables, u, place, play);
    return static_n + sp_hammerstein_branch_sum(held, config->n_branches);
}

#endif
