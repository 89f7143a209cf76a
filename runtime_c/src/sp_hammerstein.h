/* Hammerstein: a spring, Maxwell branches and stop operators, each of a curve of its own that never
 * falls with the depth:
 *
 *     force = bias + spring(u) + sum over branches of highpass(g_i(u)) + sum over stops
 *
 * Every weight is non-negative and every pole real, so that the force is passive: over any closed
 * press it takes at least the energy that it gives back. A stop is P(u) - P(play): the first half
 * is part of the spring's curve. A tick moves the branches (sp_poles.h, sp_depth.h) between reading
 * their curves at u and summing up here. */
#ifndef SP_HAMMERSTEIN_H
#define SP_HAMMERSTEIN_H

#include <stdint.h>

#include "sp_curve.h"
#include "sp_stops.h"

enum { SP_HAMMERSTEIN_LANES = 4 /* where there are vectors, branches are padded to whole ones */ };

typedef struct {
    sp_real origin_m;
    sp_real u_per_m; /* 1/m */
    sp_real bias_n;
    uint32_t n_intervals;
    uint32_t n_branches;
    uint32_t n_stops;
} sp_hammerstein_config;

/* The caller's arrays: constants. Curves as in sp_curve.h, N. */
typedef struct {
    const sp_real *spring;   /* one curve */
    const sp_real *branches; /* n_branches curves */
    const sp_real *stops;    /* n_stops times one curve */
    const sp_real *radius;   /* [n_stops], of u */
} sp_hammerstein_tables;

/* u of a depth of x, m. */
static inline sp_real sp_hammerstein_u(const sp_hammerstein_config *config, sp_real x)
{
    return (x - config->origin_m) * config->u_per_m;
}

/* u has been here for ever: every branch has relaxed. before, held: [n_branches]; play: [n_stops].
 */
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

/* What the spring, the stops and the bias give at u; moves the plays. */
static inline sp_real sp_hammerstein_static_force(const sp_hammerstein_config *config,
                                                  const sp_hammerstein_tables *tables, sp_real u,
                                                  sp_curve_position place, sp_real *play)
{
    sp_real still_n;
    sp_curve(tables->spring, 1, place, &still_n);
    still_n += config->bias_n;
    for (uint32_t k = 0; k < config->n_stops; k++) {
        const sp_real *stop = tables->stops + k * (config->n_intervals + 1) * 2;
        sp_real stop_n;
        play[k] = sp_stops_play(play[k], u, tables->radius[k]);
        sp_curve(stop, 1, sp_curve_locate(play[k], config->n_intervals), &stop_n);
        still_n -= stop_n;
    }
    return still_n;
}

/* Four partial sums in one fixed order. */
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

/* What the branches hold now (`held`), the spring, the stops and the bias at u: N. */
static inline sp_real sp_hammerstein_force(const sp_hammerstein_config *config,
                                           const sp_hammerstein_tables *tables, sp_real u,
                                           sp_curve_position place, const sp_real *held,
                                           sp_real *play)
{
    const sp_real still_n = sp_hammerstein_static_force(config, tables, u, place, play);
    return still_n + sp_hammerstein_branch_sum(held, config->n_branches);
}

#endif
