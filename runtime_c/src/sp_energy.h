/* Account of energy: over any motion the hand gets back no more than it has paid.
 *
 * A force that is held for a tick makes the work exact: from x[n-1] to x[n] the hand pays
 *
 *     E += F[n-1] (x[n] - x[n-1]) + b (x[n] - x[n-1])^2/dt,    E = min(E, W(x[n]))
 *     on the way out, |F[n]| |x[n] - x[n-1]| <= E/2
 *
 * with b of the device itself: the passivity observer and controller of Hannaford and Ryu (2002),
 * its energies those of Ryu, Kwon and Hannaford (2004). W(x), the most that the object can store at
 * a depth, forgets what was lost as heat; b dx^2/dt allows, tick by tick, what Colgate's condition
 * b > K dt/2 does.
 *
 * Without a sample the tool is taken to go on as it went, and the hand to turn as fast as it did of
 * late, if that takes energy: the account pays for it, and the next sample sets it right. The force
 * falls with the square of the depth to which the tool goes on. A hand at rest did not turn: its
 * force stays. A call that comes late falls from then on: until then the device held the force that
 * it had, and that is what the hand got. */
#ifndef SP_ENERGY_H
#define SP_ENERGY_H

#include <stdint.h>

#include "sp_notes.h"
#include "sp_number.h"
#include "sp_silence.h"

typedef struct {
    sp_real slack_m; /* 1.5 steps of the encoder: they are no motion */
    sp_real from_m;  /* W(x) = most_j + push_n u + stiffness_npm u^2, u = x - from_m >= 0 */
    sp_real most_j;
    sp_real push_n;
    sp_real stiffness_npm;
    sp_real look_ticks; /* between two looks at how the tool moves */
    sp_real keep;       /* of the greatest change of a step, from look to look */
} sp_energy_config;

typedef struct {
    sp_real left_j;     /* E */
    sp_real position_m; /* up to which it is paid */
    sp_real looked_m;   /* where the tool was at the last look */
    sp_real ticks;      /* since then */
    sp_real step_m;     /* mean way of the tool in a tick */
    sp_real bend_m;     /* mean change of that in a tick */
    sp_real turn_m;     /* greatest change of late, and less and less */
    sp_real held_n;     /* force before the last silence */
    sp_real rest_m;     /* where the tool is but for its encoder's noise at rest */
} sp_energy_state;

/* In a silence a hand may turn so many times faster than it did of late. */
#define SP_ENERGY_DOUBT ((sp_real)1.5)

/* Of slack_m, on each side of a tool at rest: a position between two steps of its encoder that is
 * noisy by one goes to and fro by two. */
#define SP_ENERGY_PLAY ((sp_real)0.6875)

/* W(x), J. */
static inline sp_real sp_energy_most(const sp_energy_config *config, sp_real x)
{
    const sp_real way = x - config->from_m;
    const sp_real u = way > (sp_real)0 ? way : (sp_real)0;
    return config->most_j + u * (config->push_n + u * config->stiffness_npm);
}

/* What was pressed before is not known. */
static inline void sp_energy_restart(const sp_energy_config *config, sp_energy_state *state,
                                     sp_real x)
{
    state->left_j = sp_energy_most(config, x);
    state->position_m = x;
    state->looked_m = x;
    state->ticks = (sp_real)0;
    state->step_m = (sp_real)0;
    state->bend_m = (sp_real)0;
    state->turn_m = (sp_real)0;
    state->held_n = (sp_real)0;
    state->rest_m = x;
}

/* How the tool moved since the last look. */
SP_RARE void sp_energy_look(const sp_energy_config *config, sp_energy_state *state, sp_real x)
{
    const sp_real way_m = x - state->looked_m;
    const sp_real moved_m = sp_abs(way_m) > config->slack_m ? way_m : (sp_real)0;
    const sp_real per_tick = (sp_real)1 / state->ticks;
    const sp_real step_m = moved_m * per_tick;
    const sp_real bend_m = (step_m - state->step_m) * per_tick;
    const sp_real turn_m = sp_flushed(state->turn_m * config->keep);
    state->step_m = step_m;
    state->bend_m = bend_m;
    state->turn_m = sp_abs(bend_m) > turn_m ? sp_abs(bend_m) : turn_m;
    state->looked_m = x;
    state->ticks = (sp_real)0;
}

/* The step that a tool may go on by: 0 within a play as wide as its encoder's noise at rest. An
 * account without anything left would else cut the force of a hand that rests, each time that its
 * encoder steps outwards. */
static inline sp_real sp_energy_on(const sp_energy_config *config, sp_real *rest_m, sp_real x,
                                   sp_real step_m)
{
    const sp_real play_m = SP_ENERGY_PLAY * config->slack_m;
    const sp_real in_m = x - play_m;
    const sp_real out_m = x + play_m;
    if (in_m > *rest_m || out_m < *rest_m) {
        *rest_m = in_m > *rest_m ? in_m : out_m;
        return step_m;
    }
    return (sp_real)0;
}

/* Under forces from held_n to given_n the tool came to x, so many ticks after the last sample, of
 * which step_m is the last; damped_j went into the device's own friction. Returns the step that it
 * may go on by: 0 at rest. */
static inline sp_real sp_energy_pay(const sp_energy_config *config, sp_energy_state *state,
                                    sp_real given_n, sp_real held_n, sp_real x, sp_real ticks,
                                    sp_real step_m, sp_real damped_j)
{
    const sp_real moved_m = x - state->position_m;
    sp_real left_j = state->left_j + damped_j;
    if (sp_abs(moved_m) > config->slack_m) {
        const sp_real paid_j = given_n * moved_m;
        const sp_real least_j = held_n * moved_m;
        left_j += least_j < paid_j ? least_j : paid_j;
        state->position_m = x;
    }
    const sp_real most_j = sp_energy_most(config, x);
    state->left_j = sp_bounded(left_j < most_j ? left_j : most_j);
    state->ticks += ticks;
    if (state->ticks >= config->look_ticks) {
        sp_energy_look(config, state, x);
    }
    return sp_energy_on(config, &state->rest_m, x, step_m);
}

/* The force that the account can pay for, N, if the tool goes on by step_m. */
static inline sp_real sp_energy_limit(const sp_energy_state *state, sp_real step_m, sp_real force_n,
                                      int *notes)
{
    const sp_real asked_j = -(force_n * step_m);
    const sp_real may_j = state->left_j > (sp_real)0 ? state->left_j * (sp_real)0.5 : (sp_real)0;
    if (!(asked_j > may_j)) {
        return force_n;
    }
    const sp_real share = may_j / asked_j;
    *notes |= SP_NOTE_ENERGY;
    return share < (sp_real)1 ? force_n * share : force_n;
}

/* Share of the force that is left at another depth: its square, for objects stiffen. */
static inline sp_real sp_energy_share(sp_real from_m, sp_real to_m)
{
    if (!(to_m < from_m) || !(from_m > (sp_real)0)) {
        return (sp_real)1;
    }
    const sp_real share = to_m > (sp_real)0 ? to_m / from_m : (sp_real)0;
    return share < (sp_real)1 ? share * share : (sp_real)1;
}

/* Whole ticks, to the nearest; whatever a stray write made of them. */
static inline uint32_t sp_energy_ticks(sp_real ticks)
{
    if (!(ticks > (sp_real)0)) {
        return 0u;
    }
    return (uint32_t)((ticks < SP_SILENCE_MOST ? ticks : SP_SILENCE_MOST) + (sp_real)0.5);
}

/* So many ticks without a good sample have passed, after `silent` of them, under held_n; returns
 * what can still be paid of given_n. */
SP_RARE sp_real sp_energy_wait(const sp_energy_config *config, sp_energy_state *state,
                               sp_real silent, sp_real ticks, sp_real held_n, sp_real given_n,
                               int *notes)
{
    if (!(silent > (sp_real)0)) {
        state->held_n = held_n;
    }
    const uint32_t begin = sp_energy_ticks(silent);
    const uint32_t end = ticks > (sp_real)0 ? sp_energy_ticks(silent + ticks) : begin;
    for (uint32_t i = begin; i < end; i++) {
        const sp_real at = (sp_real)(i + 1u);
        const sp_real on_m = state->step_m + at * state->bend_m;
        const sp_real turned_m = at * (SP_ENERGY_DOUBT * state->turn_m);
        const sp_real step_m = held_n > (sp_real)0 ? on_m - turned_m : on_m + turned_m;
        const sp_real work_j = held_n * step_m;
        if (work_j < (sp_real)0) {
            const sp_real depth_m = state->position_m - config->from_m;
            state->left_j = sp_bounded(state->left_j + work_j);
            state->position_m = sp_bounded(state->position_m + step_m);
            given_n *= sp_energy_share(depth_m, depth_m + on_m);
            given_n = sp_energy_limit(state, step_m, given_n, notes);
        }
    }
    return given_n;
}

#endif
