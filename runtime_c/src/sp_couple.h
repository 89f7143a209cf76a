/* Virtual coupling (the paper's figure 12c, Algorithm 1): the model's force moves a proxy mass,
 * which a spring and a damper connect to the tool:
 *
 *     m a_p = -f_M - k (x_p - x) - b (v_p - v)      positions into the object, f_M >= 0 pushing out
 *     force = k (x - x_p) + b (v - v_p)             positive outward
 *
 * The paper computes f_M at the tool. Computed at the proxy instead (sp_couple_proxy_position), the
 * loop renders the coupling in series with the object, which is never stiffer than k.
 *
 * Stepped exactly instead of by Euler: with e = x_p - x and w = v_p - v, and the tool moving at v
 * within the step, (e + f_M/k, w) is multiplied by the matrix exponential `phi`. Stable for every
 * positive stiffness, damping and mass.
 *
 * Rounding depends on the order of a sum: left to right, parentheses first, the tool's motion
 * before the proxy's motion relative to it. The numpy reference adds in the same order, and no flag
 * may let a compiler choose another (flags.mk). */
#ifndef SP_COUPLE_H
#define SP_COUPLE_H

#include <stdint.h>

#include "sp_number.h"

typedef struct {
    sp_real stiffness_npm;
    sp_real damping_nspm;
    sp_real compliance_mpn; /* 1/k */
    sp_real dt_s;
    sp_real phi[4]; /* exp([[0, 1], [-k/m, -b/m]] dt), row by row */
} sp_couple_config;

typedef struct {
    sp_real proxy_m;
    sp_real proxy_mps;
    uint32_t set; /* 1 while the proxy exists: from contact to release */
} sp_couple_state;

static inline void sp_couple_release(sp_couple_state *state)
{
    state->set = 0;
}

/* Depth at which the model is evaluated: that of the proxy, a point mass that a spring and
 * damper join to the tool. It is created at first contact. m. */
static inline sp_real sp_couple_proxy_position(sp_couple_state *state, sp_real x, sp_real v)
{
    if (!state->set) {
        /* It begins at the tool's velocity: at rest the damper would kick with b v. */
        state->proxy_m = x;
        state->proxy_mps = v;
        state->set = 1;
    }
    return state->proxy_m;
}

/* Force of spring and damper on the tool, N; then move the proxy by a tick under that spring,
 * that damper and the model's force (phi: the exact solution over dt). */
static inline sp_real sp_couple_step(const sp_couple_config *config, sp_couple_state *state,
                                     sp_real x, sp_real v, sp_real model_n)
{
    const sp_real e = state->proxy_m - x;
    const sp_real w = state->proxy_mps - v;
    const sp_real force_n = -(config->stiffness_npm * e) - config->damping_nspm * w;
    const sp_real rest = -(config->compliance_mpn * model_n);
    const sp_real from_rest = e - rest;
    const sp_real *phi = config->phi;
    state->proxy_m =
        sp_clamp_state(x + config->dt_s * v + (rest + (phi[0] * from_rest + phi[1] * w)));
    state->proxy_mps = sp_clamp_state(v + (phi[2] * from_rest + phi[3] * w));
    return force_n;
}

#endif
