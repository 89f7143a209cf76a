/* Flow: branches that relax faster the larger their force is, as polymers do (Bergstroem and Boyce,
 * J. Mech. Phys. Solids 46, 1998; Norton's law of creep).
 *
 *     h' = b' - rate |h|^(p - 1) h,   p = 3 or 5,   b = u, u^2 or u^4, straight beyond u = 1
 *
 * A tick takes half of b's rise, relaxes by the exact solution over dt, and takes the other half:
 *
 *     |h|^(1-p) grows by (p - 1) rate dt:  h (1 + (p - 1) rate dt |h|^(p - 1))^(-1/(p - 1))
 *
 * The factor lies between 0 and 1, so any step is stable and dissipates. Square roots alone give
 * the same bits on every processor. */
#ifndef SP_FLOW_H
#define SP_FLOW_H

#include <stdint.h>

#include "sp_number.h"

enum { SP_FLOW_FUNCTIONS = 3 /* u, u^2, u^4 */ };

/* Evaluate the three fixed functions b(u) that drive nonlinear dashpots: u, u^2 and u^4,
 * straight on beyond the depth of training. */
static inline void sp_flow_inputs(sp_real u, sp_real *values)
{
    const sp_real v = u > (sp_real)0 ? u : (sp_real)0;
    const sp_real inside = v < (sp_real)1 ? v : (sp_real)1;
    const sp_real beyond = v - inside;
    const sp_real square = inside * inside;
    values[0] = v;
    values[1] = square + (sp_real)2 * beyond;
    values[2] = square * square + (sp_real)4 * beyond;
}

/* Set the state of an object that has rested at u for a long time. */
static inline void sp_flow_rest(sp_real u, uint32_t n, sp_real *before, sp_real *h)
{
    sp_flow_inputs(u, before);
    for (uint32_t i = 0; i < n; i++) {
        h[i] = (sp_real)0;
    }
}

/* Half the rise of each function b since the last tick: one half acts before the relaxation, the
 * other after it, so that a tick is of second order in dt. before: the functions at the last tick.
 */
static inline void sp_flow_half_increments(sp_real u, sp_real *before, sp_real *rises)
{
    sp_real now[SP_FLOW_FUNCTIONS];
    sp_flow_inputs(u, now);
    for (uint32_t k = 0; k < SP_FLOW_FUNCTIONS; k++) {
        rises[k] = (sp_real)0.5 * (now[k] - before[k]);
        before[k] = now[k];
    }
}

/* Advance one branch by a tick: half the rise of b, the exact solution of h' = -rate |h|^(p - 1) h
 * over dt, and the other half. loss: (p - 1) rate dt; cubic: p is 3, else 5. Returns h. */
static inline sp_real sp_flow_relax(sp_real h, sp_real half, sp_real loss, uint32_t cubic)
{
    const sp_real held = sp_clamp_state(h + half);
    const sp_real size = sp_abs(held);
    const sp_real square = size * size;
    const sp_real grown = cubic ? sp_sqrt((sp_real)1 + loss * square)
                                : sp_sqrt(sp_sqrt((sp_real)1 + loss * (square * square)));
    return sp_flush_denormal(held / grown + half);
}

/* Advance n branches by a tick. function: index of each branch's b; the first n_cubic have p = 3,
 * the others 5. Returns the sum of force_n h, N. */
static inline sp_real sp_flow(const sp_real *loss, const sp_real *force_n, const uint8_t *function,
                              uint32_t n_cubic, uint32_t n, sp_real u, sp_real *before, sp_real *h)
{
    sp_real rises[SP_FLOW_FUNCTIONS];
    sp_flow_half_increments(u, before, rises);
    sp_real sum_n = (sp_real)0;
    for (uint32_t i = 0; i < n; i++) {
        h[i] = sp_flow_relax(h[i], rises[function[i]], loss[i], i < n_cubic);
        sum_n += force_n[i] * h[i];
    }
    return sum_n;
}

#endif
