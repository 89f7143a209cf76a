/* Input guard: rejects implausible positions and holds the last good one.
 *
 * A sample is implausible if it is not finite, outside [min_m, max_m], or further from the last
 * good one than a hand can have moved since. Denormals become 0. After `resync_ticks` samples in a
 * row that agree with each other the guard accepts the new position and restarts the history, so
 * that a sensor that jumped once does not hold the force for ever. */
#ifndef SP_GUARD_H
#define SP_GUARD_H

#include <stdint.h>

#include "sp_notes.h"
#include "sp_number.h"

typedef struct {
    sp_real max_step_m;    /* largest plausible step, m a tick */
    sp_real min_m;         /* smallest plausible position */
    sp_real max_m;         /* largest plausible position */
    sp_real air_m;         /* any step is plausible between positions at or below this one */
    uint32_t resync_ticks; /* agreeing samples after which a new position is accepted */
} sp_guard_config;

typedef struct {
    sp_real last_good_m;
    sp_real candidate_m;
    uint32_t agreeing_samples;
    uint32_t started;
} sp_guard_state;

/* Magic number that sp_init writes; sp_step refuses a state without it. */
#define SP_STATE_MAGIC 0x5b9a3c1fu

static inline int sp_guard_plausible(const sp_guard_config *config, sp_real x)
{
    return x == x && x >= config->min_m && x <= config->max_m; /* false for NaN */
}

/* Clamp a computed position (proxy, missed tick) to the plausible range. */
static inline sp_real sp_guard_clamp(const sp_guard_config *config, sp_real x)
{
    const sp_real below = x < config->max_m ? x : config->max_m;
    return below > config->min_m ? below : config->min_m;
}

/* Accept or reject the sample x. ticks: since the last good sample. Returns the position to use, m;
 * 0 before the first plausible sample. */
static inline sp_real sp_guard_accept(const sp_guard_config *config, sp_guard_state *state,
                                      sp_real ticks, sp_real x, int *notes)
{
    x = sp_flush_denormal(x);
    if (!sp_guard_plausible(config, x)) {
        state->agreeing_samples = 0;
        *notes |= SP_NOTE_HELD;
        return state->last_good_m;
    }
    if (!state->started) {
        state->started = 1;
        state->last_good_m = x;
        *notes |= SP_NOTE_RESYNC;
        return x;
    }
    if (sp_abs(x - state->last_good_m) <= config->max_step_m * ticks ||
        (x <= config->air_m && state->last_good_m <= config->air_m)) {
        state->agreeing_samples = 0;
        state->last_good_m = x;
        return x;
    }
    const int agrees =
        state->agreeing_samples && sp_abs(x - state->candidate_m) <= config->max_step_m;
    state->agreeing_samples = agrees ? state->agreeing_samples + 1 : 1;
    state->candidate_m = x;
    if (state->agreeing_samples < config->resync_ticks) {
        *notes |= SP_NOTE_HELD;
        return state->last_good_m;
    }
    state->agreeing_samples = 0;
    state->last_good_m = x;
    *notes |= SP_NOTE_RESYNC;
    return x;
}

/* Fraction of the held force to render while a sample is rejected: less if the sample is shallower
 * than the last good one, 0 above the surface. */
static inline sp_real sp_guard_held_fraction(const sp_guard_config *config,
                                             const sp_guard_state *state, sp_real x)
{
    x = sp_flush_denormal(x);
    if (!sp_guard_plausible(config, x)) {
        return (sp_real)1;
    }
    if (!(x > (sp_real)0)) {
        return (sp_real)0;
    }
    const sp_real fraction = x < state->last_good_m ? x / state->last_good_m : (sp_real)1;
    return fraction < (sp_real)1 ? fraction : (sp_real)1;
}

#endif
