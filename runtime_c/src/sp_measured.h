/* Poles over a measured time step: the same recurrence as sp_poles.h, exact whatever dt is.
 *
 *     u = dt/tau,  phi(u) = (1 - exp(-u))/u:   loss = u phi(u),  gain = phi(u)
 *
 * What is read off a pole has the gain of the planned step folded in: per_gain takes it out again.
 * phi comes from its series and from halving u, so that no libm is needed and the bits are the same
 * everywhere: phi(2 u) = phi(u) (1 - u phi(u)/2). */
#ifndef SP_MEASURED_H
#define SP_MEASURED_H

#include <stdint.h>

#include "sp_number.h"

enum { SP_MEASURED_HALVINGS = 16 /* to a quarter, from time steps of 16 000 time constants */ };

/* (1 - exp(-u))/u for u >= 0, within 1e-7 of it. */
static inline sp_real sp_measured_phi(sp_real u)
{
    const sp_real quarter = (sp_real)0.25;
    const sp_real upper = quarter * (sp_real)(1u << SP_MEASURED_HALVINGS);
    uint32_t halvings = 0;
    if (!(u < upper)) {
        return (sp_real)1 / u; /* of exp(-u) nothing is left: u phi is 1 */
    }
    for (uint32_t k = 0; k < SP_MEASURED_HALVINGS; k++) {
        if (!(u > quarter)) {
            break;
        }
        u *= (sp_real)0.5;
        halvings++;
    }
    sp_real phi = (sp_real)1;
    for (uint32_t k = 7; k >= 2; k--) {
        phi = (sp_real)1 - u / (sp_real)k * phi;
    }
    for (; halvings > 0; halvings--) {
        const sp_real half = (sp_real)0.5 * u * phi; /* of 1 - exp(-u), whatever was rounded */
        phi *= (sp_real)1 - (half < (sp_real)0.5 ? half : (sp_real)0.5);
        u *= (sp_real)2;
    }
    return phi;
}

/* 1 - exp(-u) for u >= 0. */
static inline sp_real sp_measured_loss(sp_real u)
{
    const sp_real loss = u * sp_measured_phi(u);
    return loss < (sp_real)1 ? loss : (sp_real)1;
}

/* All poles see the same input, which rose by `rise` in dt_s. */
static inline void sp_measured_shared(const sp_real *per_tau, const sp_real *per_gain,
                                      uint32_t n_poles, sp_real dt_s, sp_real rise, sp_real *h)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        const sp_real u = dt_s * per_tau[i];
        const sp_real phi = sp_measured_phi(u);
        h[i] = sp_flushed(sp_bounded(h[i] + (rise * (phi * per_gain[i]) - u * phi * h[i])));
    }
}

/* Each pole has an input of its own: g now, `before` at the last tick. */
static inline void sp_measured_apart(const sp_real *per_tau, const sp_real *per_gain,
                                     uint32_t n_poles, sp_real dt_s, const sp_real *g,
                                     sp_real *before, sp_real *h)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        sp_measured_shared(per_tau + i, per_gain + i, 1, dt_s, g[i] - before[i], h + i);
        before[i] = g[i];
    }
}

/* Poles kept in double, as in sp_slow_poles.h; out: in the scene's type. */
static inline void sp_measured_slow(const sp_real *per_tau, const sp_real *per_gain,
                                    uint32_t n_poles, sp_real dt_s, sp_real rise, double *h,
                                    sp_real *out)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        const sp_real u = dt_s * per_tau[i];
        const sp_real phi = sp_measured_phi(u);
        const double rises = (double)(rise * (phi * per_gain[i]));
        h[i] = sp_flushed_double(sp_bounded_double(h[i] + (rises - (double)(u * phi) * h[i])));
        out[i] = (sp_real)h[i];
    }
}

/* The same, each pole with an input of its own. */
static inline void sp_measured_slow_apart(const sp_real *per_tau, const sp_real *per_gain,
                                          uint32_t n_poles, sp_real dt_s, const sp_real *g,
                                          sp_real *before, double *h, sp_real *out)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        sp_measured_slow(per_tau + i, per_gain + i, 1, dt_s, g[i] - before[i], h + i, out + i);
        before[i] = g[i];
    }
}

#endif
