/* Hammerstein: a spring, Maxwell branches and stop operators on a monotone basis of the depth.
 *
 *     force = bias + g_0(u) + sum over branches of highpass(g_i(u)) + sum over stops
 *
 * Every weight is non-negative and every pole real, so that the force is passive: over any closed
 * press it takes at least the energy that it gives back. */
#ifndef SP_HAMMERSTEIN_H
#define SP_HAMMERSTEIN_H

#include <stdint.h>

#include "sp_basis.h"
#include "sp_poles.h"
#include "sp_stops.h"
#include "sp_weigh.h"

typedef struct {
    sp_real origin_m;
    sp_real per_span; /* 1/m */
    sp_real bias_n;
    uint32_t n_basis;    /* SP_BASIS_POWERS or SP_BASIS_RAMPS */
    uint32_t n_branches; /* lane 0 is the spring, lanes 1 .. n_branches have a pole */
    uint32_t n_lanes;
    uint32_t n_stops;
} sp_hammerstein_config;

/* The caller's arrays: constants, and the state's members. */
typedef struct {
    const sp_real *weights;      /* [n_basis][n_lanes], N */
    const sp_real *loss;         /* [n_lanes] */
    const sp_real *stop_weights; /* [n_stops][n_basis], N */
    const sp_real *radius;       /* [n_stops], of u */
} sp_hammerstein_tables;

static inline void sp_hammerstein_basis(uint32_t n_basis, sp_real u, sp_real *b)
{
    if (n_basis == SP_BASIS_POWERS) {
        sp_basis_powers(u, b);
    } else {
        sp_basis_ramps(u, b);
    }
}

/* x has been here for ever: every branch has relaxed. before, held: [n_lanes]; play: [n_stops]. */
static inline void sp_hammerstein_rest(const sp_hammerstein_config *config,
                                       const sp_hammerstein_tables *tables, sp_real x,
                                       sp_real *before, sp_real *held, sp_real *play)
{
    const sp_real u = (x - config->origin_m) * config->per_span;
    sp_real b[SP_BASIS_RAMPS];
    sp_hammerstein_basis(config->n_basis, u, b);
    sp_weigh(tables->weights, b, config->n_basis, config->n_lanes, before);
    for (uint32_t i = 0; i < config->n_lanes; i++) {
        held[i] = (sp_real)0;
    }
    for (uint32_t k = 0; k < config->n_stops; k++) {
        play[k] = u;
    }
}

/* One tick at depth x, m; g: room for [n_lanes]. Returns N. */
static inline sp_real sp_hammerstein_step(const sp_hammerstein_config *config,
                                          const sp_hammerstein_tables *tables, sp_real x,
                                          sp_real *before, sp_real *held, sp_real *play, sp_real *g)
{
    const sp_real u = (x - config->origin_m) * config->per_span;
    sp_real b[SP_BASIS_RAMPS];
    sp_hammerstein_basis(config->n_basis, u, b);
    sp_weigh(tables->weights, b, config->n_basis, config->n_lanes, g);
    sp_poles_apart(tables->loss, config->n_lanes, g, before, held);
    sp_real force_n = config->bias_n + g[0];
    for (uint32_t i = 1; i <= config->n_branches; i++) {
        force_n += held[i];
    }
    for (uint32_t k = 0; k < config->n_stops; k++) {
        sp_real p[SP_BASIS_RAMPS];
        play[k] = sp_stops_play(play[k], u, tables->radius[k]);
        sp_hammerstein_basis(config->n_basis, play[k], p);
        force_n +=
            sp_stops_force(tables->stop_weights + k * config->n_basis, b, p, config->n_basis);
    }
    return force_n;
}

#endif
