/* springpot 0.1.0 86b16118cb54dfc4c8e67997fce67e0a33dbec4fecb42abb280fc9382212af05 */
/* springpot: the feel of a recorded soft object, one force a tick.
 *
 * The loop of a haptic device, at the rate SP_RATE_HZ:
 *
 *     static sp_state state;
 *     sp_init(&state);
 *     every period:  sp_step(&state, position_m, velocity_mps, &force_n);
 *     no sample came: sp_idle(&state, period_s, &force_n);
 *
 * Signs: position is the penetration from the undeformed surface, positive into the object; at or
 * below 0 there is no contact. Force is positive where it pushes the tool out of the object.
 * Units: m, m/s, N, s.
 *
 * Nothing here allocates, blocks, reads a clock, or keeps anything outside the state; two states
 * never meet. One state belongs to one thread. Send the force in the tick that computed it: one
 * tick of delay costs most of the stiffness that a loop can render stably.
 *
 * Time goes on without samples. Whatever was missed (sp_idle, a sample that is not believed), the
 * next good sample makes up for: the object's memory, the coupling's proxy and every
 * filter go through those ticks as if the tool had moved evenly since the last good sample, and the
 * force is the model's again at once where that is lower, within 10 ms where it is higher. Such a
 * call takes as many ticks' time as went by. Without a good sample the force never rises; if that
 * lasts for longer than the watchdog's time, or comes again and again, it goes to zero and stays
 * there until sp_reset.
 *
 * This header and sp.c are the whole scene: add both to any project, as C11, or as C++17 with
 * the source renamed to sp.cpp. What they need of a compiler they say themselves: no flag has to
 * be set, and -ffast-math is refused. Call sp_selftest() once on the device, before the first
 * force: it finds a compiler that changes floating-point results all the same.
 *
 * What a call returns: 0, fine; positive, notes (bits, below): the force is safe; negative,
 * misuse: nothing has changed, and *force_n was not written.
 */
#ifndef SP_H
#define SP_H

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
    SP_NOTE_LATCHED = 32, /* the watchdog tripped: the force goes to zero, until sp_reset */
    SP_NOTE_LIMITED = 64  /* the force grew faster than a touch makes it: held back */
};

enum {
    SP_ERROR_NULL = -1,      /* a pointer that is needed is null */
    SP_ERROR_TIME_STEP = -2, /* a time step that is not finite, not positive, or too long */
    SP_ERROR_STATE = -3      /* memory that is no state: call sp_init first */
};
/* springpot declarations end */

#endif

#ifdef __cplusplus
extern "C" {
#endif

/* springpot declarations begin */
typedef struct sp_state sp_state;

/* Version of this interface; a host refuses a library of another. */
uint32_t sp_abi_version(void);

/* Bytes of one sp_state; align it as for double. */
uint32_t sp_state_size(void);

/* JSON: version, hash, units, sample time, number type, trained range. */
const char *sp_manifest(void);

/* First call on a state; sp_reset is the same for a state in use, and unlatches the watchdog. */
void sp_init(sp_state *state);
void sp_reset(sp_state *state);

/* One tick: the newest position (m) in, the force (N) out. velocity_mps is not used: a coupling
 * estimates the tool's own, since a second signal of the same motion could contradict the first. */
int sp_step(sp_state *state, float position_m, float velocity_mps, float *force_n);

/* n ticks in order; velocity_mps, not used, may be null. Returns all notes. */
int sp_run(sp_state *state, uint32_t n, const float *position_m, const float *velocity_mps,
           float *force_n);

/* dt_s (s) have passed without a sample: the force stays, or falls if the tool was on its way out,
 * until the watchdog takes it to zero. */
int sp_idle(sp_state *state, float dt_s, float *force_n);

/* Replay the golden vectors that were emitted and compare bits: 0, or 1 + the first tick that
 * differs, or one more than there are ticks where NaN is assumed away or a long silence does not
 * latch. Catches a compiler with defaults that change floating-point results. Needs sp_state_size()
 * bytes of stack more than a tick. */
int sp_selftest(void);
/* springpot declarations end */

/* A loop can check that the scene was made for it:
 * _Static_assert((int)SP_RATE_HZ == 1000, "emit the scene with the rate of this loop"); */
#define SP_RATE_HZ 1000
#define SP_DT_S 0.001f
#define SP_MAX_FORCE_N 12.0f
#define SP_TRAINED_DEPTH_M 0.01f
#define SP_WATCHDOG_S 0.02f
#define SP_STATE_BYTES 184

/* What one tick hands to the next, here so that a state can be allocated: not to be read, nor
 * written, but by the functions above. */
typedef struct {
    float silent_s; /* since the last good sample; 0 once latched */
    float debt_s;   /* silence not yet paid back by good ticks */
    uint32_t latched;
} sp_silence_state;

typedef struct {
    float last_good_m;
    float candidate_m;
    uint32_t agreeing_samples;
    uint32_t started;
} sp_guard_state;

typedef struct {
    float last_n; /* by the last call: from here the force grows */
    float share;  /* 0 .. 1, of the model's force that is given */
} sp_output_state;

struct sp_state {
    uint32_t begun;
    sp_silence_state silence;
    sp_guard_state guard;
    float remainder_s;
    float history[2 * 16];
    uint32_t newest;
    uint32_t simd;
    uint32_t bins[1];
    sp_output_state output;
};

/* Fails where a header of another number type or version was included first. */
typedef char sp_state_is_as_planned[sizeof(struct sp_state) == 184 ? 1 : -1];

/* For the picture of a game, where no hand feels the force: the ticks of `seconds`, 1 s at most, with the
 * tool on a straight line from its last good position to this one. What is left of a tick is kept for
 * the next call. Returns all notes, or misuse; *force_n is that of the last tick. */
static inline int sp_advance(sp_state *state, float seconds, float position_m, float *force_n)
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
    const float ticks = since_s / SP_DT_S + (float)0.001;
    const uint32_t n_ticks = ticks > 0.0f ? (uint32_t)ticks : 0u;
    const float from_m = state->guard.started ? state->guard.last_good_m : position_m;
    const float step_m = (position_m - from_m) * (SP_DT_S / (since_s > 0.0f ? since_s : 1.0f));
    *force_n = state->output.last_n;
    for (uint32_t tick = 1; tick <= n_ticks; tick++) {
        const int tick_notes = sp_step(state, from_m + (float)tick * step_m, 0.0f, force_n);
        if (tick_notes < 0) {
            return tick_notes;
        }
        notes |= tick_notes;
    }
    state->remainder_s = since_s - (float)n_ticks * SP_DT_S;
    return notes;
}

#ifdef __cplusplus
}
#endif

#endif
