/* Silence: how long no good sample came. Everything that remembers is moved through that time by
 * the next good sample, as if the tool had moved evenly; too long a silence is latched, and so are
 * silences that add up: a good tick makes up for 5/32 of a silent one, so that a source that is
 * silent for more than a seventh of the time ends. */
#ifndef SP_SILENCE_H
#define SP_SILENCE_H

#include <stdint.h>

#include "sp_number.h"

typedef struct {
    sp_real dt_s;       /* of a tick */
    sp_real per_dt;     /* 1/dt_s, 1/s */
    sp_real watchdog_s; /* longest time without a good sample, and half a tick */
} sp_silence_config;

typedef struct {
    sp_real silent_s; /* since the last good sample; 0 once it is latched */
    sp_real lost_s;   /* silence that good samples have not yet made up for */
    uint32_t latched;
} sp_silence_state;

/* Of a silent tick, what a good one makes up for: if every third tick is silent, that ends within
 * five times the watchdog's time. */
#define SP_SILENCE_WORTH ((sp_real)0.15625)

/* A good sample, of a tick of tick_s. */
static inline void sp_silence_heard(sp_silence_state *state, sp_real tick_s)
{
    state->silent_s = (sp_real)0;
    if (state->lost_s > (sp_real)0) {
        state->lost_s -= SP_SILENCE_WORTH * tick_s;
    }
}

/* Latched ticks of one call, at most: every force has fallen in fewer. */
#define SP_SILENCE_MOST ((sp_real)1048576)

/* dt_s have passed without a good sample; returns how many ticks of them it was latched. */
static inline sp_real sp_silence_passed(const sp_silence_config *config, sp_silence_state *state,
                                        sp_real dt_s)
{
    const sp_real ticks = dt_s * config->per_dt;
    if (state->latched) {
        return ticks;
    }
    const sp_real silent_s = state->silent_s + dt_s;
    const sp_real lost_s = (state->lost_s > (sp_real)0 ? state->lost_s : (sp_real)0) + dt_s;
    if (lost_s <= config->watchdog_s) {
        state->silent_s = silent_s < config->watchdog_s ? silent_s : config->watchdog_s;
        state->lost_s = lost_s;
        return (sp_real)0;
    }
    const sp_real beyond = (lost_s - config->watchdog_s) * config->per_dt;
    const sp_real most = beyond < SP_SILENCE_MOST ? beyond : SP_SILENCE_MOST;
    const sp_real over = (sp_real)((uint32_t)most + 1u);
    state->latched = 1;
    state->silent_s = (sp_real)0;
    state->lost_s = (sp_real)0;
    return over < ticks ? over : ticks;
}

/* Ticks without a good sample before this one, which lasts tick_s: no more than the watchdog
 * allows, whatever a stray write made of the state. */
static inline uint32_t sp_silence_missed(const sp_silence_config *config,
                                         const sp_silence_state *state, sp_real tick_s)
{
    const sp_real most_s = config->watchdog_s;
    const sp_real silent_s = state->silent_s < most_s ? state->silent_s : most_s;
    const sp_real ticks = (silent_s + tick_s) * config->per_dt;
    return ticks >= (sp_real)1.5 ? (uint32_t)(ticks - (sp_real)0.5) : 0;
}

/* Shortest time step, of a tick: what is divided by it stays finite. */
#define SP_SILENCE_SHORTEST ((sp_real)0.0009765625)

/* What the last tick lasts, s, after the `left` ones that were missed. */
static inline sp_real sp_silence_last(const sp_silence_config *config,
                                      const sp_silence_state *state, sp_real tick_s, uint32_t left)
{
    const sp_real last_s = state->silent_s + tick_s - (sp_real)left * config->dt_s;
    const sp_real shortest_s = SP_SILENCE_SHORTEST * config->dt_s;
    return last_s > shortest_s ? last_s : shortest_s;
}

#endif
