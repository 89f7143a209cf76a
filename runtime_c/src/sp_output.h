/* Output limiter: clamp, slew limit, start ramp, latched fall. Every force leaves through it.
 *
 * A lower force acts at once. A higher one is limited twice: it rises by at most slew_n a call, and
 * after a start at depth the ramp scales the model's force by a fraction that grows from 0 to 1.
 * Without a sample the force never rises; once latched it falls to zero and stays there.
 * docs/explanation/output.md has the equations. */
#ifndef SP_OUTPUT_H
#define SP_OUTPUT_H

#include "sp_notes.h"
#include "sp_number.h"

typedef struct {
    sp_real min_n;
    sp_real max_n;
    sp_real slew_n; /* slew limit, N a call: faster than any touch, so it stops faults only */
    sp_real ramp_per_tick; /* growth of the start ramp */
    sp_real latch_fall_n;  /* fall of a latched force, N a tick */
} sp_output_config;

typedef struct {
    sp_real last_n; /* force of the last call */
    sp_real ramp;   /* fraction of the model's force that is rendered, 0 .. 1 */
} sp_output_state;

/* After a restart at depth the force rises from zero. */
static inline void sp_output_begin_ramp(sp_output_state *state)
{
    state->ramp = (sp_real)0;
}

/* Without contact no ramp is needed: the next contact begins at zero force by itself. */
static inline void sp_output_end_ramp(sp_output_state *state)
{
    state->ramp = (sp_real)1;
}

/* Clamp a force outside the limits (rare). NaN fails both comparisons and becomes 0. */
SP_COLD sp_real sp_output_clamp_cold(const sp_output_config *config, sp_real force_n, int *notes)
{
    *notes |= SP_NOTE_CLAMPED;
    return force_n > config->max_n   ? config->max_n
           : force_n < config->min_n ? config->min_n
                                     : (sp_real)0;
}

/* Clamp the force to the scene's limits. */
static inline sp_real sp_output_clamp(const sp_output_config *config, sp_real force_n, int *notes)
{
    if (force_n >= config->min_n && force_n <= config->max_n) {
        return force_n;
    }
    return sp_output_clamp_cold(config, force_n, notes);
}

/* Lower the latched force by `ticks` ticks. last_n is clamped first, in case a stray write
 * corrupted it. */
SP_COLD sp_real sp_output_fall_latched(const sp_output_config *config, sp_output_state *state,
                                       sp_real ticks, int *notes)
{
    const sp_real last_n = sp_output_clamp(config, state->last_n, notes);
    const sp_real step = config->latch_fall_n * ticks;
    const sp_real down_n = last_n - step;
    const sp_real up_n = last_n + step;
    state->last_n = down_n > (sp_real)0 ? down_n : up_n < (sp_real)0 ? up_n : (sp_real)0;
    *notes |= SP_NOTE_LATCHED;
    return state->last_n;
}

/* The last rendered force if it has the sign of `force_n`, else 0: from there a force may grow
 * by a step, and fall at once. */
static inline sp_real sp_output_last_along(const sp_output_state *state, sp_real force_n)
{
    const sp_real zero = (sp_real)0;
    const sp_real last_n = state->last_n;
    if (force_n > zero) {
        return last_n > zero ? last_n : zero;
    }
    return last_n < zero ? last_n : zero;
}

/* Limit the model's force of a good sample. Only growth away from 0 is limited: a force may fall at
 * once. ticks: of this call, at most 1. Returns the force to render, N. */
static inline sp_real sp_output_limit(const sp_output_config *config, sp_output_state *state,
                                      sp_real ticks, sp_real force_n, int *notes)
{
    if (state->ramp < (sp_real)1) {
        force_n *= state->ramp;
        state->ramp += config->ramp_per_tick * ticks;
        *notes |= SP_NOTE_RAMPED;
    }
    force_n = sp_output_clamp(config, force_n, notes);
    const sp_real slew_n = config->slew_n * ticks;
    const sp_real before_n = sp_output_last_along(state, force_n);
    const sp_real upper_n = before_n + slew_n;
    const sp_real lower_n = before_n - slew_n;
    if (force_n > (sp_real)0) {
        if (force_n > upper_n) {
            *notes |= SP_NOTE_LIMITED;
            force_n = upper_n;
        }
    } else if (force_n < lower_n) {
        *notes |= SP_NOTE_LIMITED;
        force_n = lower_n;
    }
    state->last_n = force_n;
    return force_n;
}

#endif
