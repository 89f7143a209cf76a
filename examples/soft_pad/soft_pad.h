/* springpot 0.1.0 36b45672261fbeea2e45da40e1370bc5d5b6205383a22d5e1a407afb1bee26f5 */
/* springpot: the feel of a recorded soft object, one force a tick.
 *
 * The loop of a haptic device, at the rate SOFT_PAD_RATE_HZ:
 *
 *     static soft_pad_state state;
 *     soft_pad_init(&state);
 *     every period:  soft_pad_step(&state, position_m, velocity_mps, &force_n);
 *     no sample came: soft_pad_idle(&state, period_s, &force_n);
 *
 * Signs: position is the penetration from the undeformed surface, positive into the object; at or
 * below 0 there is no contact. Force is positive where it pushes the tool out of the object.
 * Units: m, m/s, N, s.
 *
 * Nothing here allocates, blocks, reads a clock, or keeps anything outside the state; two states
 * never meet. One state belongs to one thread. Send the force in the tick that computed it: one
 * tick of delay costs most of the stiffness that a loop can render stably.
 *
 * Time goes on without samples. Whatever was missed (soft_pad_idle, a sample that is not believed), the
 * next good sample makes up for: the object's memory, the coupling's proxy and every
 * filter go through those ticks as if the tool had moved evenly since the last good sample, and the
 * force is the model's again at once where that is lower, within 10 ms where it is higher. Such a
 * call takes as many ticks' time as went by. Without a good sample the force never rises; if that
 * lasts for longer than the watchdog's time, or comes again and again, it goes to zero and stays
 * there until soft_pad_reset.
 *
 * This header and soft_pad.c are the whole scene: add both to any project, as C11, or as C++17 with
 * the source renamed to soft_pad.cpp. What they need of a compiler they say themselves: no flag has to
 * be set, and -ffast-math is refused. Call soft_pad_selftest() once on the device, before the first
 * force: it finds a compiler that changes floating-point results all the same.
 *
 * What a call returns: 0, fine; positive, notes (bits, below): the force is safe; negative,
 * misuse: nothing has changed, and *force_n was not written.
 */
#ifndef SOFT_PAD_H
#define SOFT_PAD_H

#include <stdint.h>

#ifndef SP_NOTES_H
#define SP_NOTES_H

/* springpot declarations begin */
enum {
    SP_NOTE_HELD = 1,     /* the sample was missing or not believable: the last good one was held */
    SP_NOTE_RESYNC = 2,   /* a new position was taken as true: history restarts at it */
    SP_NOTE_OUTSIDE = 4,  /* outside the trained depth: the model saw the nearest trained one */
    SP_NOTE_CLAMPED = 8,  /* the force was cut to the scene's limits */
    SP_NOTE_RAMPED = 16,  /* the force rises after a start or restart at depth, or a silence */
    SP_NOTE_LATCHED = 32, /* the watchdog tripped: the force goes to zero, until soft_pad_reset */
    SP_NOTE_LIMITED = 64  /* the force grew faster than a touch makes it: held back */
};

enum {
    SP_ERROR_NULL = -1,      /* a pointer that is needed is null */
    SP_ERROR_TIME_STEP = -2, /* a time step that is not finite, not positive, or too long */
    SP_ERROR_STATE = -3      /* memory that is no state: call soft_pad_init first */
};
/* springpot declarations end */

#endif

#ifdef __cplusplus
extern "C" {
#endif

/* springpot declarations begin */
typedef struct soft_pad_state soft_pad_state;

/* Version of this interface; a host refuses a library of another. */
uint32_t soft_pad_abi_version(void);

/* Bytes of one soft_pad_state; align it as for double. */
uint32_t soft_pad_state_size(void);

/* JSON: version, hash, units, sample time, number type, trained range. */
const char *soft_pad_manifest(void);

/* First call on a state; soft_pad_reset is the same for a state in use, and unlatches the watchdog. */
void soft_pad_init(soft_pad_state *state);
void soft_pad_reset(soft_pad_state *state);

/* One tick: the newest position (m) in, the force (N) out. velocity_mps is not used: a coupling
 * estimates the tool's own, since a second signal of the same motion could contradict the first. */
int soft_pad_step(soft_pad_state *state, float position_m, float velocity_mps, float *force_n);

/* n ticks in order; velocity_mps, not used, may be null. Returns all notes. */
int soft_pad_run(soft_pad_state *state, uint32_t n, const float *position_m, const float *velocity_mps,
           float *force_n);

/* dt_s (s) have passed without a sample: the force stays, or falls if the tool was on its way out,
 * until the watchdog takes it to zero. */
int soft_pad_idle(soft_pad_state *state, float dt_s, float *force_n);

/* Replay the golden vectors that were emitted and compare bits: 0, or 1 + the first tick that
 * differs, or one more than there are ticks where NaN is assumed away or a long silence does not
 * latch. Catches a compiler with defaults that change floating-point results. Needs soft_pad_state_size()
 * bytes of stack more than a tick. */
int soft_pad_selftest(void);
/* springpot declarations end */

/* A loop can check that the scene was made for it:
 * _Static_assert((int)SOFT_PAD_RATE_HZ == 1000, "emit the scene with the rate of this loop"); */
#define SOFT_PAD_RATE_HZ 1000
#define SOFT_PAD_DT_S 0.001f
#define SOFT_PAD_MAX_FORCE_N 12.002745f
#define SOFT_PAD_TRAINED_DEPTH_M 0.0144908f
#define SOFT_PAD_WATCHDOG_S 0.02f
#define SOFT_PAD_STATE_BYTES 160

/* What one tick hands to the next, here so that a state can be allocated: not to be read, nor
 * written, but by the functions above. */
typedef struct {
    float silent_s; /* since the last good sample; 0 once latched */
    float debt_s;   /* silence not yet paid back by good ticks */
    uint32_t latched;
} soft_pad_silence_state;

typedef struct {
    float last_good_m;
    float candidate_m;
    uint32_t agreeing_samples;
    uint32_t started;
} soft_pad_guard_state;

typedef struct {
    float u;       /* of the model in the last tick, as in sp_curve.h */
    float force_n; /* which it had there */
} soft_pad_surface_state;

typedef struct {
    float last_n; /* by the last call: from here the force grows */
    float share;  /* 0 .. 1, of the model's force that is given */
} soft_pad_output_state;

struct soft_pad_state {
    uint32_t begun;
    soft_pad_silence_state silence;
    soft_pad_guard_state guard;
    float remainder_s;
    float penetration_before[12];
    float penetration_held[12];
    float penetration_play[3];
    soft_pad_surface_state penetration_surface;
    soft_pad_output_state output;
};

/* Fails where a header of another number type or version was included first. */
typedef char soft_pad_state_is_as_planned[sizeof(struct soft_pad_state) == 160 ? 1 : -1];

/* For the picture of a game, where no hand feels the force: the ticks of `seconds`, 1 s at most, with the
 * tool on a straight line from its last good position to this one. What is left of a tick is kept for
 * the next call. Returns all notes, or misuse; *force_n is that of the last tick. */
static inline int soft_pad_advance(soft_pad_state *state, float seconds, float position_m, float *force_n)
{
    int notes = 0;
    if (!state || !force_n) {
        return SP_ERROR_NULL;
    }
    if (!(seconds >= 0.0f && seconds <= 1.0f)) {
        return SP_ERROR_TIME_STEP;
    }
    /* Since the last tick; a thousandth of a tick is rounding. */
    const float since_s = state->remainder_s + seconds;
    const float ticks = since_s / SOFT_PAD_DT_S + (float)0.001;
    const uint32_t n_ticks = ticks > 0.0f ? (uint32_t)ticks : 0u;
    const float from_m = state->guard.started ? state->guard.last_good_m : position_m;
    const float step_m = (position_m - from_m) * (SOFT_PAD_DT_S / (since_s > 0.0f ? since_s : 1.0f));
    *force_n = state->output.last_n;
    for (uint32_t tick = 1; tick <= n_ticks; tick++) {
        const int tick_notes = soft_pad_step(state, from_m + (float)tick * step_m, 0.0f, force_n);
        if (tick_notes < 0) {
            return tick_notes;
        }
        notes |= tick_notes;
    }
    state->remainder_s = since_s - (float)n_ticks * SOFT_PAD_DT_S;
    return notes;
}

#ifdef __cplusplus
}
#endif

#endif
