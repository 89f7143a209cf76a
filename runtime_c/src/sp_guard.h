/* Guard: the position that the rest of the tick may believe.
 *
 * A sample that is not finite, too far away to be real, or further from the last good one than the
 * hand can have moved since is not taken; a denormal one is 0. After `resync_ticks` samples that
 * agree with each other, the new position is taken as true: a stall must not hold for ever. */
#ifndef SP_GUARD_H
#define SP_GUARD_H

#include <stdint.h>

#include "sp_notes.h"
#include "sp_number.h"

typedef struct {
    sp_real max_step_m;    /* maximum believable step, m a tick */
    sp_real min_m;         /* believable positions: from here */
    sp_real max_m;         /* to here */
    sp_real air_m;         /* at most there nothing is touched: any step is plausible */
    uint32_t resync_ticks; /* agreeing_samples samples after which a new position is true */
} sp_guard_config;

typedef struct {
    sp_real last_good_m;
    sp_real candidate_m;
    uint32_t agreeing_samples;
    uint32_t started;
} sp_guard_state;

/* What sp_init writes into a state: memory that it never saw does not hold this word. */
#define SP_STATE_MAGIC 0x5b9a3c1fu

static inline int sp_guard_plausible(const sp_guard_config *config, sp_real x)
{
    return x == x && x >= config->min_m && x <= config->max_m; /* a NaN is not itself */
}

/* The nearest believable position: for a way that was never measured. */
static inline sp_real sp_guard_clamp(const sp_guard_config *config, sp_real x)
{
    const sp_real below = x < config->max_m ? x : config->max_m;
    return below > config->min_m ? below : config->min_m;
}

/* ticks: since the last good sample. Returns the position to use, m; before the first believable
 * sample, 0. */
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

/* While a sample is not taken, the last force is held; this is the share of it that acts. A sample
 * that may be true, and is less deep than the last good one, gets less; above the surface, none. */
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
    const sp_real share = x < state->last_good_m ? x / state->last_good_m : (sp_real)1;
    return share < (sp_real)1 ? share : (sp_real)1;
}

#endif
