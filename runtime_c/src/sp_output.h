/* Output: the last word on the force. It rises from zero after a restart at depth, stays within
 * the scene's limits, and goes to zero when samples stop coming; that last state is latched. */
#ifndef SP_OUTPUT_H
#define SP_OUTPUT_H

#include <stdint.h>

#include "sp_notes.h"
#include "sp_number.h"

typedef struct {
    sp_real min_n;
    sp_real max_n;
    sp_real slew_n;     /* maximum growth of the force in one tick: a fault's, not a touch's */
    sp_real rise;       /* share of the force gained in one tick of the ramp */
    sp_real fall_nps;   /* speed of the watchdog's way to zero */
    sp_real watchdog_s; /* longest time without a good sample */
    sp_real dt_s;
} sp_output_config;

typedef struct {
    sp_real force_n;
    sp_real share; /* 0 .. 1: how far the ramp has risen */
    sp_real silent_s;
    uint32_t latched;
} sp_output_state;

/* The ramp starts again: a position was taken as true without a history. */
static inline void sp_output_restart(sp_output_state *state)
{
    state->share = (sp_real)0;
}

/* No contact: whatever comes next starts from zero by itself. */
static inline void sp_output_free(sp_output_state *state)
{
    state->share = (sp_real)1;
    state->force_n = (sp_real)0;
}

/* dt_s have passed; was there a good sample in them? */
static inline void sp_output_watch(const sp_output_config *config, sp_output_state *state,
                                   sp_real dt_s, int good)
{
    state->silent_s = good ? (sp_real)0 : state->silent_s + dt_s;
    if (state->silent_s > config->watchdog_s) {
        state->latched = 1;
    }
}

static inline sp_real sp_output_fall(const sp_output_config *config, sp_output_state *state,
                                     sp_real dt_s, int *notes)
{
    const sp_real step = config->fall_nps * dt_s;
    const sp_real size = sp_abs(state->force_n);
    const sp_real left = size > step ? size - step : (sp_real)0;
    state->force_n = state->force_n < (sp_real)0 ? -left : left;
    *notes |= SP_NOTE_LATCHED;
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

static inline sp_real sp_output_force(const sp_output_config *config, sp_output_state *state,
                                      sp_real force_n, int *notes)
{
    if (state->latched) {
        return sp_output_fall(config, state, config->dt_s, notes);
    }
    if (state->share < (sp_real)1) {
        force_n *= state->share;
        state->share += config->rise;
        *notes |= SP_NOTE_RAMPED;
    }
    force_n = sp_output_slew(config->slew_n, state->force_n, force_n, notes);
    if (!(force_n >= config->min_n && force_n <= config->max_n)) {
        /* A NaN compares with nothing: it becomes 0. */
        force_n = force_n > config->max_n   ? config->max_n
                  : force_n < config->min_n ? config->min_n
                                            : (sp_real)0;
        *notes |= SP_NOTE_CLAMPED;
    }
    state->force_n = force_n;
    return force_n;
}

static inline sp_real sp_output_idle(const sp_output_config *config, sp_output_state *state,
                                     sp_real dt_s, int *notes)
{
    sp_output_watch(config, state, dt_s, 0);
    if (state->latched) {
        return sp_output_fall(config, state, dt_s, notes);
    }
    *notes |= SP_NOTE_HELD;
    return state->force_n;
}

#endif
