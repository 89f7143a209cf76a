/* Output: the last word on the force. It rises from zero after a restart at depth, stays within
 * the scene's limits, and goes to zero when samples stop coming.
 *
 * Without samples the force goes on as it last changed, less and less. The next good one may have
 * another force: it is gone to a tick at a time, a little faster than the model's itself has
 * changed since: no kick, and it arrives. */
#ifndef SP_OUTPUT_H
#define SP_OUTPUT_H

#include <stdint.h>

#include "sp_notes.h"
#include "sp_number.h"

typedef struct {
    sp_real min_n;
    sp_real max_n;
    sp_real slew_n;   /* maximum growth of the force in one tick: a fault's, not a touch's */
    sp_real rise;     /* share of the force gained in one tick of the ramp */
    sp_real fall_n;   /* of the force in one tick once it is latched */
    sp_real return_n; /* change in one tick, at least, of a force on its way to the model's */
} sp_output_config;

/* Speed of that way, of the model's own change in a tick; and how fast that may grow: what the even
 * motion did not have is felt little by little. */
#define SP_OUTPUT_PACE ((sp_real)1.2)
#define SP_OUTPUT_HURRY ((sp_real)1.03)

/* Without samples the force goes on as it last changed, less and less. */
#define SP_OUTPUT_DECAY ((sp_real)0.9)

typedef struct {
    sp_real force_n;
    sp_real share;   /* 0 .. 1: how far the ramp has risen */
    sp_real model_n; /* the model's force of the last good sample */
    sp_real slope_n; /* its change in a tick; without samples less and less */
    sp_real aim_n;   /* on the way to the model's force: where that is */
    sp_real pace_n;  /* change in one tick that is natural on the way; 0: force_n is there */
} sp_output_state;

/* The ramp starts again: a position was taken as true without a history. */
static inline void sp_output_restart(sp_output_state *state)
{
    state->share = (sp_real)0;
    state->slope_n = (sp_real)0;
    state->pace_n = (sp_real)0;
}

/* No contact: whatever comes next starts from zero by itself. */
static inline void sp_output_free(sp_output_state *state)
{
    state->share = (sp_real)1;
    state->force_n = (sp_real)0;
    state->model_n = (sp_real)0;
    state->slope_n = (sp_real)0;
    state->pace_n = (sp_real)0;
}

/* Latched, for so many ticks. */
static inline sp_real sp_output_fall(const sp_output_config *config, sp_output_state *state,
                                     sp_real ticks, int *notes)
{
    const sp_real step = config->fall_n * ticks;
    const sp_real down_n = state->force_n - step;
    const sp_real up_n = state->force_n + step;
    state->force_n = down_n > (sp_real)0 ? down_n : up_n < (sp_real)0 ? up_n : (sp_real)0;
    *notes |= SP_NOTE_LATCHED;
    return state->force_n;
}

/* Within the scene's limits; a NaN compares with nothing: it becomes 0. */
static inline sp_real sp_output_clamp(const sp_output_config *config, sp_real force_n, int *notes)
{
    if (force_n >= config->min_n && force_n <= config->max_n) {
        return force_n;
    }
    *notes |= SP_NOTE_CLAMPED;
    return force_n > config->max_n   ? config->max_n
           : force_n < config->min_n ? config->min_n
                                     : (sp_real)0;
}

/* A tick on the way to the model's force. */
static inline void sp_output_return(const sp_output_config *config, sp_output_state *state)
{
    const sp_real may_n = SP_OUTPUT_PACE * state->pace_n + config->return_n;
    const sp_real up_n = state->force_n + may_n;
    const sp_real down_n = state->force_n - may_n;
    if (state->aim_n > up_n) {
        state->force_n = up_n;
    } else if (state->aim_n < down_n) {
        state->force_n = down_n;
    } else {
        state->force_n = state->aim_n;
        state->pace_n = (sp_real)0;
    }
}

/* A good sample `ticks` after the last one; returns the force of this tick, N. */
SP_RARE sp_real sp_output_after_silence(const sp_output_config *config, sp_output_state *state,
                                        sp_real ticks, sp_real force_n, int *notes)
{
    const sp_real before_n = sp_abs(state->slope_n);
    state->aim_n = sp_output_clamp(config, force_n, notes);
    state->slope_n = (state->aim_n - state->model_n) / ticks;
    state->model_n = state->aim_n;
    const sp_real now_n = sp_abs(state->slope_n);
    const sp_real change_n = now_n > before_n ? now_n : before_n;
    const sp_real most_n = ticks > SP_OUTPUT_PACE ? change_n : SP_OUTPUT_HURRY * state->pace_n;
    const sp_real grown_n = change_n < most_n ? change_n : most_n;
    state->pace_n = grown_n > state->pace_n ? grown_n : state->pace_n;
    sp_output_return(config, state);
    if (state->pace_n > (sp_real)0) {
        *notes |= SP_NOTE_LIMITED;
    }
    return state->force_n;
}

/* The force grows by at most slew_n; it may vanish at once. */
static inline sp_real sp_output_slew(sp_real slew_n, sp_real last_n, sp_real force_n, int *notes)
{
    const sp_real zero = (sp_real)0;
    sp_real may_n;
    if (force_n > zero) {
        may_n = (last_n > zero ? last_n : zero) + slew_n;
        if (!(force_n > may_n)) {
            return force_n;
        }
    } else {
        may_n = (last_n < zero ? last_n : zero) - slew_n;
        if (!(force_n < may_n)) {
            return force_n;
        }
    }
    *notes |= SP_NOTE_LIMITED;
    return may_n;
}

/* The model's force of a good sample, `ticks` after the last one; returns what leaves, N. */
static inline sp_real sp_output_force(const sp_output_config *config, sp_output_state *state,
                                      sp_real ticks, sp_real force_n, int *notes)
{
    const sp_real last_n = state->force_n;
    if (state->share < (sp_real)1) {
        force_n *= state->share;
        state->share += config->rise * ticks;
        *notes |= SP_NOTE_RAMPED;
    }
    const int late = state->pace_n > (sp_real)0 || ticks > SP_OUTPUT_PACE;
    if (late) {
        force_n = sp_output_after_silence(config, state, ticks, force_n, notes);
    }
    force_n = sp_output_slew(config->slew_n * ticks, last_n, force_n, notes);
    state->force_n = sp_output_clamp(config, force_n, notes);
    if (!late) {
        state->slope_n = state->force_n - state->model_n;
        state->model_n = state->force_n;
    }
    return state->force_n;
}

/* So many ticks without a good sample: the force goes on, or along its way. */
static inline void sp_output_wait(const sp_output_config *config, sp_output_state *state,
                                  sp_real ticks)
{
    for (; ticks >= (sp_real)0.5; ticks -= (sp_real)1) {
        int ignored = 0;
        const int under_way = state->pace_n > (sp_real)0;
        const sp_real on_n = (under_way ? state->aim_n : state->force_n) + state->slope_n;
        const sp_real at_n = sp_output_clamp(config, on_n, &ignored);
        state->slope_n = sp_flushed(SP_OUTPUT_DECAY * state->slope_n);
        if (under_way) {
            state->aim_n = at_n;
            sp_output_return(config, state);
        } else {
            state->force_n = at_n;
        }
    }
}

#endif
