/* Output: the last word on the force.
 *
 * Down at once: a force that the model lowers is lower in the same tick. Up by two limits: never
 * more than slew_n above the force that was given before, whatever the reason that it was less; and
 * after a start at depth by a share of the model's force that rises to 1. Without a sample the
 * force never rises; latched, it falls to zero and stays there. docs/explanation/output.md has the
 * equations. */
#ifndef SP_OUTPUT_H
#define SP_OUTPUT_H

#include "sp_notes.h"
#include "sp_number.h"

typedef struct {
    sp_real min_n;
    sp_real max_n;
    sp_real slew_n; /* maximum growth of the force from call to call: a fault's, not a touch's */
    sp_real rise;   /* share of the force gained in a tick after a start or restart at depth */
    sp_real fall_n; /* of the force in one tick once it is latched */
} sp_output_config;

typedef struct {
    sp_real last_n; /* by the last call: from here the force grows */
    sp_real share;  /* 0 .. 1, of the model's force that is given */
} sp_output_state;

/* A position was taken as true without a history: the force rises from zero. */
static inline void sp_output_begin_ramp(sp_output_state *state)
{
    state->share = (sp_real)0;
}

/* No contact: whatever comes next starts from zero by itself. */
static inline void sp_output_end_ramp(sp_output_state *state)
{
    state->share = (sp_real)1;
}

/* What is not within the scene's limits; a NaN compares with nothing: it becomes 0. */
SP_COLD sp_real sp_output_clamp_cold(const sp_output_config *config, sp_real force_n, int *notes)
{
    *notes |= SP_NOTE_CLAMPED;
    return force_n > config->max_n   ? config->max_n
           : force_n < config->min_n ? config->min_n
                                     : (sp_real)0;
}

/* Within the scene's limits. */
static inline sp_real sp_output_clamp(const sp_output_config *config, sp_real force_n, int *notes)
{
    if (force_n >= config->min_n && force_n <= config->max_n) {
        return force_n;
    }
    return sp_output_clamp_cold(config, force_n, notes);
}

/* Latched, for so many ticks; from within the limits, whatever a stray write made of last_n. */
SP_COLD sp_real sp_output_fall_latched(const sp_output_config *config, sp_output_state *state,
                                       sp_real ticks, int *notes)
{
    const sp_real last_n = sp_output_clamp(config, state->last_n, notes);
    const sp_real step = config->fall_n * ticks;
    const sp_real down_n = last_n - step;
    const sp_real up_n = last_n + step;
    state->last_n = down_n > (sp_real)0 ? down_n : up_n < (sp_real)0 ? up_n : (sp_real)0;
    *notes |= SP_NOTE_LATCHED;
    return state->last_n;
}

/* The force given before, as far as it has the direction of `force_n`. */
static inline sp_real sp_output_last_along(const sp_output_state *state, sp_real force_n)
{
    const sp_real zero = (sp_real)0;
    const sp_real last_n = state->last_n;
    if (force_n > zero) {
        return last_n > zero ? last_n : zero;
    }
    return last_n < zero ? last_n : zero;
}

/* The model's force of a good sample; returns what leaves, N. ticks: of this call, at most 1. */
static inline sp_real sp_output_limit(const sp_output_config *config, sp_output_state *state,
                                      sp_real ticks, sp_real force_n, int *notes)
{
    if (state->share < (sp_real)1) {
        force_n *= state->share;
        state->share += config->rise * ticks;
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
