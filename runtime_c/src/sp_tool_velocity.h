/* Velocity of the tool for a coupling: difference of positions and a first-order low-pass. The lag
 * is the same at every speed, so the stability of the loop can be computed. Adaptive windows
 * (sp_velocity.h) lag most on the small motions of a hold, where the damper is needed. */
#ifndef SP_TOOL_VELOCITY_H
#define SP_TOOL_VELOCITY_H

#include "sp_number.h"

typedef struct {
    sp_real position_m;
    sp_real velocity_mps;
} sp_tool_velocity_state;

static inline void sp_tool_velocity_rest(sp_tool_velocity_state *state, sp_real x)
{
    state->position_m = x;
    state->velocity_mps = (sp_real)0;
}

/* Velocity by differences through a low pass of first order, m/s. weight: of the newest
 * difference, dt/(dt + time constant). */
static inline sp_real sp_tool_velocity(sp_tool_velocity_state *state, sp_real rate_hz,
                                       sp_real weight, sp_real x)
{
    const sp_real difference_mps = (x - state->position_m) * rate_hz;
    state->position_m = x;
    state->velocity_mps =
        sp_flush_denormal(state->velocity_mps + weight * (difference_mps - state->velocity_mps));
    return state->velocity_mps;
}

#endif
