/* springpot 0.1.0 1a0c939a561456cc2d81879749feac60568f79930c9197f3061a91c6f9143134 */
/* springpot: the force of a recorded soft object, tick by tick.
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
 * No function allocates, blocks, reads a clock, or keeps anything outside the state, and states are
 * independent. Use one state in one thread. Send the force in the tick that computed it: one tick
 * of delay costs most of the stiffness that a loop can render stably.
 *
 * Time goes on without samples. After missed or rejected samples (sp_idle, a note HELD) the next
 * good one advances the object's memory, the coupling's proxy and every filter through the missed
 * ticks, as if the tool had moved evenly; the force is then the model's again at once. Such a call
 * takes as long as the missed ticks together. Without a good sample the force never rises. If that
 * lasts longer than the watchdog timeout, or happens again and again, the force falls to zero and
 * stays there until sp_reset.
 *
 * This header and sp.c are the whole scene: add both to any project, as C11, or as C++17 with
 * the source renamed to sp.cpp. What they need of a compiler they say themselves: no flag has to
 * be set, and -ffast-math is refused. Call sp_selftest() once on the device, before the first
 * force: it finds a compiler that changes floating-point results all the same.
 *
 * Return values: 0, no notes; positive, notes (bits below), the force is safe; negative,
 * misuse: nothing has changed, and *force_n was not written.
 */
#ifndef SP_H
#define SP_H

#include <stdint.h>

#ifndef SP_NOTES_H
#define SP_NOTES_H

/* springpot declarations begin */
enum {
    SP_NOTE_HELD = 1,     /* the sample was missing or implausible: the last force was held */
    SP_NOTE_RESYNC = 2,   /* a position was accepted without a history, which restarts there */
    SP_NOTE_OUTSIDE = 4,  /* deeper than trained: the model got the nearest trained depth */
    SP_NOTE_CLAMPED = 8,  /* the force was clamped to the scene's limits */
    SP_NOTE_RAMPED = 16,  /* the start ramp scaled the force, after a start or restart at depth */
    SP_NOTE_LATCHED = 32, /* the watchdog has latched: the force falls to zero until sp_reset */
    SP_NOTE_LIMITED = 64  /* slew limit: the force grew faster than any touch can */
};

enum {
    SP_ERROR_NULL = -1,      /* a required pointer is null */
    SP_ERROR_TIME_STEP = -2, /* dt_s is not finite or not positive; sp_advance: negative */
    SP_ERROR_STATE = -3      /* not an initialised state: call sp_init first */
};
/* springpot declarations end */

#endif

#ifdef __cplusplus
extern "C" {
#endif

/* springpot declarations begin */
typedef struct sp_state sp_state;

/* Version of this interface; a host refuses a library of another version. */
uint32_t sp_abi_version(void);

/* Bytes of one sp_state; align it like a double. */
uint32_t sp_state_size(void);

/* JSON: version, hash, units, sample time, number type, trained range. */
const char *sp_manifest(void);

/* sp_init: first call on a state. sp_reset: the same for a state in use; unlatches the watchdog. */
void sp_init(sp_state *state);
void sp_reset(sp_state *state);

/* One tick: takes the newest position (m), writes the force (N). velocity_mps is not used: a
 * coupling estimates the velocity from positions, which a second signal could contradict. */
int sp_step(sp_state *state, float position_m, float velocity_mps, float *force_n);

/* n ticks in order. velocity_mps is not used and may be null. Returns the notes of all ticks. */
int sp_run(sp_state *state, uint32_t n, const float *position_m, const float *velocity_mps,
           float *force_n);

/* dt_s (s) have passed without a sample: the force holds until the watchdog latches, then falls to
 * zero. */
int sp_idle(sp_state *state, float dt_s, float *force_n);

/* For a game's picture, without a hand in the loop: run the ticks of `seconds` with the tool on a
 * straight line from where it was to position_m, no faster than a hand and no deeper than trained,
 * and keep the rest of a tick for the next call. Of more than 1 s the last second counts. NaN
 * leaves the tool where it was (note HELD); no position latches. Writes the force of the last tick.
 * Returns the notes of all ticks, or an error. */
int sp_advance(sp_state *state, float seconds, float position_m, float *force_n);

/* Replay the golden ticks and compare bits. Returns 0 if all agree, else 1 + the first tick that
 * differs (n_ticks + 1: a NaN comparison or the latch test failed). Catches a compiler whose
 * defaults change floating-point results. Needs sp_state_size() bytes more stack than a tick. */
int sp_selftest(void);
/* springpot declarations end */

/* A loop can check its rate at compile time:
 * _Static_assert((int)SP_RATE_HZ == 1000, "emit the scene with the rate of this loop"); */
#define SP_RATE_HZ 1000
#define SP_DT_S 0.001f
#define SP_MAX_FORCE_N 10.955592f
#define SP_TRAINED_DEPTH_M 0.011998461f
#define SP_WATCHDOG_S 0.02f
#define SP_STATE_BYTES 108

/* State from tick to tick. It is declared here so that it can be allocated; only the functions of
 * this file read or write it. */
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
    float u;       /* normalised depth of the model in the last tick (sp_curve.h) */
    float force_n; /* its force there */
} sp_surface_state;

typedef struct {
    float position_m;
    float velocity_mps;
} sp_tool_velocity_state;

typedef struct {
    float proxy_m;
    float proxy_mps;
    uint32_t set; /* 1 while the proxy exists: from contact to release */
} sp_couple_state;

typedef struct {
    float last_n; /* force of the last call */
    float ramp;   /* fraction of the model's force that is rendered, 0 .. 1 */
} sp_output_state;

struct sp_state {
    uint32_t begun;
    sp_silence_state silence;
    sp_guard_state guard;
    float remainder_s;
    float penetration_before[4];
    float penetration_held[4];
    float penetration_play[1];
    sp_surface_state penetration_surface;
    sp_tool_velocity_state tool_velocity;
    sp_couple_state couple;
    sp_output_state output;
};

/* Fails if a header of another number type or version was included first. */
typedef char sp_state_is_as_planned[sizeof(struct sp_state) == 108 ? 1 : -1];

#ifdef __cplusplus
}
#endif

#endif
