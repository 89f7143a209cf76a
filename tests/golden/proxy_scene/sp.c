constants of this scene; the tick; the functions of the header; the self-test. */
#include "sp.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* A product and a sum are two roundings, on every processor. For gcc, nothing reads errno either: a
 * square root is one instruction. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC push_options
#pragma GCC optimize("fp-contract=off", "no-math-errno")
#else
#pragma STDC FP_CONTRACT OFF
#endif

/* Fails where int has fewer than 32 bits. */
typedef char sp_int_is_as_planned[sizeof(int) >= 4 ? 1 : -1];

/* ------------------------------------------------------------------------------------ sp_real.h */

#define SP_REAL_MAX FLT_MAX

/* Instructions with every FPU: no library is called. */
#define sp_abs(x) fabsf(x)
#define sp_sqrt(x) sqrtf(x)

/* ---------------------------------------------------------------------------------- sp_number.h */

/* The few number helpers that the units share. */

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0)
#error                                                                                             \
    "springpot needs IEEE arithmetic: build without -ffast-math, -ffinite-math-only"
#endif

/* A function that few ticks call, out of the way of the others; and a long one that is called in
 * two places: a copy in each would cost the inlining within it. */
#if defined(__GNUC__)
#define SP_RARE __attribute__((noinline, cold, unused)) static
#define SP_APART __attribute__((noinline)) static
#else
#define SP_RARE static inline
#define SP_APART static
#endif

/* A length of time: positive, not infinite and not NaN, without libm. */
static inline int sp_is_time(float x)
{
    return x == x && x > (float)0 && x <= SP_REAL_MAX;
}

/* Values below this are 0: a denormal costs a hundred times a number's time on some processors. */
#define SP_SMALLEST_DOUBLE 1e-30
#define SP_SMALLEST ((float)SP_SMALLEST_DOUBLE)

static inline float sp_flushed(float x)
{
    return sp_abs(x) < SP_SMALLEST ? (float)0 : x;
}

/* Far above every state of a model in its units. Where bounds of one step do not add up to a bound
 * of the state (a measured time step, a mass on a spring), it is stated. The analysis shows that no
 * NaN comes here; one would become the largest. */
#define SP_LARGEST 1e6

static inline float sp_bounded(float x)
{
    const float below = x < (float)SP_LARGEST ? x : (float)SP_LARGEST;
    return below > (float)-SP_LARGEST ? below : (float)-SP_LARGEST;
}

/* --------------------------------------------------------------------------------- sp_silence.h */

/* Silence: how long no good sample came. Everything that remembers is moved through that time by
 * the next good sample, as if the tool had moved evenly; too long a silence is latched, and so are
 * silences that add up: a good tick makes up for 5/32 of a silent one, so that a source that is
 * silent for more than a seventh of the time ends. */

typedef struct {
    float dt_s;       /* of a tick */
    float per_dt;     /* 1/dt_s, 1/s */
    float watchdog_s; /* longest time without a good sample, and half a tick */
} sp_silence_config;

/* Of a silent tick, what a good one makes up for: if every third tick is silent, that ends within
 * five times the watchdog's time. */
#define SP_SILENCE_WORTH ((float)0.15625)

/* A good sample, of a tick of tick_s. */
static inline void sp_silence_heard(sp_silence_state *state, float tick_s)
{
    state->silent_s = (float)0;
    if (state->lost_s > (float)0) {
        state->lost_s -= SP_SILENCE_WORTH * tick_s;
    }
}

/* Latched ticks of one call, at most: every force has fallen in fewer. */
#define SP_SILENCE_MOST ((float)1048576)

/* dt_s have passed without a good sample; returns how many ticks of them it was latched. */
static inline float sp_silence_passed(const sp_silence_config *config, sp_silence_state *state,
                                        float dt_s)
{
    const float ticks = dt_s * config->per_dt;
    if (state->latched) {
        return ticks;
    }
    const float silent_s = state->silent_s + dt_s;
    const float lost_s = (state->lost_s > (float)0 ? state->lost_s : (float)0) + dt_s;
    if (lost_s <= config->watchdog_s) {
        state->silent_s = silent_s < config->watchdog_s ? silent_s : config->watchdog_s;
        state->lost_s = lost_s;
        return (float)0;
    }
    const float beyond = (lost_s - config->watchdog_s) * config->per_dt;
    const float most = beyond < SP_SILENCE_MOST ? beyond : SP_SILENCE_MOST;
    const float over = (float)((uint32_t)most + 1u);
    state->latched = 1;
    state->silent_s = (float)0;
    state->lost_s = (float)0;
    return over < ticks ? over : ticks;
}

/* Ticks without a good sample before this one, which lasts tick_s: no more than the watchdog
 * allows, whatever a stray write made of the state. */
static inline uint32_t sp_silence_missed(const sp_silence_config *config,
                                         const sp_silence_state *state, float tick_s)
{
    const float most_s = config->watchdog_s;
    const float silent_s = state->silent_s < most_s ? state->silent_s : most_s;
    const float ticks = (silent_s + tick_s) * config->per_dt;
    return ticks >= (float)1.5 ? (uint32_t)(ticks - (float)0.5) : 0;
}

/* Shortest time step, of a tick: what is divided by it stays finite. */
#define SP_SILENCE_SHORTEST ((float)0.0009765625)

/* ----------------------------------------------------------------------------------- sp_guard.h */

/* Guard: the position that the rest of the tick may believe.
 *
 * A sample that is not finite, too far away to be real, or further from the last good one than the
 * hand can have moved since is not taken; a denormal one is 0. After `resync_ticks` samples that
 * agree with each other, the new position is taken as true: a stall must not hold for ever. */

typedef struct {
    float jump_m;        /* maximum believable step, m a tick */
    float min_m;         /* believable positions: from here */
    float max_m;         /* to here */
    uint32_t resync_ticks; /* agreeing samples after which a new position is true */
} sp_guard_config;

/* What sp_init writes into a state: memory that it never saw does not hold this word. */
#define SP_GUARD_BEGUN 0x5b9a3c1fu

static inline int sp_guard_plausible(const sp_guard_config *config, float x)
{
    return x == x && x >= config->min_m && x <= config->max_m; /* a NaN is not itself */
}

/* A way that was never measured does not leave the believable positions. */
static inline float sp_guard_within(const sp_guard_config *config, float x)
{
    const float below = x < config->max_m ? x : config->max_m;
    return below > config->min_m ? below : config->min_m;
}

/* ticks: since the last good sample. Returns the position to use, m; before the first believable
 * sample, 0. */
static inline float sp_guard_position(const sp_guard_config *config, sp_guard_state *state,
                                        float ticks, float x, int *notes)
{
    x = sp_flushed(x);
    if (!sp_guard_plausible(config, x)) {
        state->agreeing = 0;
        *notes |= SP_NOTE_HELD;
        return state->good_m;
    }
    if (!state->started) {
        state->started = 1;
        state->good_m = x;
        *notes |= SP_NOTE_RESYNC;
        return x;
    }
    if (sp_abs(x - state->good_m) <= config->jump_m * ticks) {
        state->agreeing = 0;
        state->good_m = x;
        return x;
    }
    const int agrees = state->agreeing && sp_abs(x - state->suspect_m) <= config->jump_m;
    state->agreeing = agrees ? state->agreeing + 1 : 1;
    state->suspect_m = x;
    if (state->agreeing < config->resync_ticks) {
        *notes |= SP_NOTE_HELD;
        return state->good_m;
    }
    state->agreeing = 0;
    state->good_m = x;
    *notes |= SP_NOTE_RESYNC;
    return x;
}

/* Share of the held force that a sample which is not taken may feel: where it may be true, no more
 * than its depth's, and none above the surface. */
static inline float sp_guard_share(const sp_guard_config *config, const sp_guard_state *state,
                                     float x)
{
    x = sp_flushed(x);
    if (!sp_guard_plausible(config, x)) {
        return (float)1;
    }
    if (!(x > (float)0)) {
        return (float)0;
    }
    const float share = x < state->good_m ? x / state->good_m : (float)1;
    return share < (float)1 ? share : (float)1;
}

/* ----------------------------------------------------------------------------------- sp_range.h */

/* Trained range: the model never sees a depth that it was not trained on. */

typedef struct {
    float min_m;
    float max_m;
} sp_range_config;

static inline float sp_range_clip(const sp_range_config *config, float x, int *notes)
{
    if (x > config->max_m) {
        *notes |= SP_NOTE_OUTSIDE;
        return config->max_m;
    }
    if (x < config->min_m) {
        *notes |= SP_NOTE_OUTSIDE;
        return config->min_m;
    }
    return x;
}

/* ----------------------------------------------------------------------------------- sp_curve.h */

/* Curves of the depth: smooth, and monotone.
 *
 * u is 0 at the lowest trained position and 1 at the maximum. Each curve is given at equally spaced
 * nodes from 0 to 1 by its value and its slope. Between nodes the slope is straight, so that the
 * curve is a parabola; beyond the last one it goes on straight. With slopes >= 0 it never falls. */

typedef struct {
    uint32_t piece;
    float way; /* from the start of the piece, 1 at its end; beyond 1 in the last piece */
} sp_curve_place;

/* Curves do not move below u = 0. n_pieces: those between nodes, and the one beyond. */
static inline sp_curve_place sp_curve_at(float u, uint32_t n_pieces)
{
    const float per_piece = (float)(n_pieces > 1u ? n_pieces - 1u : 1u);
    const float last = (float)(n_pieces - 1u);
    const float passed = u > (float)0 ? u * per_piece : (float)0;
    const float found = passed < last ? passed : last;
    sp_curve_place place;
    place.piece = (uint32_t)found;
    place.way = passed - (float)place.piece;
    return place;
}

/* nodes: [n_pieces + 1][2][n_curves], the values and the slopes a piece, at each node; the last row
 * repeats the slopes. values: [n_curves]. */
static inline void sp_curve(const float *nodes, uint32_t n_curves, sp_curve_place place,
                            float *values)
{
    const float *value = nodes + place.piece * 2 * n_curves;
    const float *slope = value + n_curves;
    const float *next = slope + 2 * n_curves;
    const float half = (float)0.5 * place.way;
    for (uint32_t i = 0; i < n_curves; i++) {
        values[i] = value[i] + place.way * (slope[i] + half * (next[i] - slope[i]));
    }
}

/* ----------------------------------------------------------------------------------- sp_stops.h */

/* Stop operators (Prandtl-Ishlinskii): P(u) - P(p), where p, the play, follows u at a distance of
 * at most its radius. Rate-independent loss; with a P that never falls, never a gain of energy. */

static inline float sp_stops_play(float play, float u, float radius)
{
    const float low = u - radius;
    const float high = u + radius;
    const float raised = play > low ? play : low;
    return raised < high ? raised : high;
}

/* ----------------------------------------------------------------------------- sp_hammerstein.h */

/* Hammerstein: a spring, Maxwell branches and stop operators, each of a curve of its own that never
 * falls with the depth:
 *
 *     force = bias + spring(u) + sum over branches of highpass(g_i(u)) + sum over stops
 *
 * Every weight is non-negative and every pole real, so that the force is passive: over any closed
 * press it takes at least the energy that it gives back. A stop is P(u) - P(play): the first half
 * is part of the spring's curve. A tick moves the branches (sp_poles.h, sp_depth.h) between reading
 * their curves at u and summing up here. */

enum { SP_HAMMERSTEIN_SUMS = 4 /* where there are vectors, branches are padded to whole ones */ };

typedef struct {
    float origin_m;
    float per_span; /* 1/m */
    float bias_n;
    uint32_t n_pieces;
    uint32_t n_branches;
    uint32_t n_stops;
} sp_hammerstein_config;

/* The caller's arrays: constants. Curves as in sp_curve.h, N. */
typedef struct {
    const float *spring;   /* one curve */
    const float *branches; /* n_branches curves */
    const float *stops;    /* n_stops times one curve */
    const float *radius;   /* [n_stops], of u */
} sp_hammerstein_tables;

/* u of a depth of x, m. */
static inline float sp_hammerstein_share(const sp_hammerstein_config *config, float x)
{
    return (x - config->origin_m) * config->per_span;
}

/* u has been here for ever: every branch has relaxed. before, held: [n_branches]; play: [n_stops].
 */
static inline void sp_hammerstein_rest(const sp_hammerstein_config *config,
                                       const sp_hammerstein_tables *tables, float u,
                                       float *before, float *held, float *play)
{
    sp_curve(tables->branches, config->n_branches, sp_curve_at(u, config->n_pieces), before);
    for (uint32_t i = 0; i < config->n_branches; i++) {
        held[i] = (float)0;
    }
    for (uint32_t k = 0; k < config->n_stops; k++) {
        play[k] = u;
    }
}

/* What the spring, the stops and the bias give at u; moves the plays. */
static inline float sp_hammerstein_still(const sp_hammerstein_config *config,
                                           const sp_hammerstein_tables *tables, float u,
                                           sp_curve_place place, float *play)
{
    float still_n;
    sp_curve(tables->spring, 1, place, &still_n);
    still_n += config->bias_n;
    for (uint32_t k = 0; k < config->n_stops; k++) {
        const float *stop = tables->stops + k * (config->n_pieces + 1) * 2;
        float stop_n;
        play[k] = sp_stops_play(play[k], u, tables->radius[k]);
        sp_curve(stop, 1, sp_curve_at(play[k], config->n_pieces), &stop_n);
        still_n -= stop_n;
    }
    return still_n;
}

/* Four partial sums in one fixed order. */
static inline float sp_hammerstein_held(const float *held, uint32_t n_branches)
{
    float sum[SP_HAMMERSTEIN_SUMS] = {0};
    const uint32_t whole = n_branches - n_branches % SP_HAMMERSTEIN_SUMS;
    for (uint32_t i = 0; i < whole; i += SP_HAMMERSTEIN_SUMS) {
#pragma GCC unroll 4
        for (uint32_t k = 0; k < SP_HAMMERSTEIN_SUMS; k++) {
            sum[k] += held[i + k];
        }
    }
#pragma GCC unroll 4
    for (uint32_t i = whole; i < n_branches; i++) {
        sum[i - whole] += held[i];
    }
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/* What the branches hold now (`held`), the spring, the stops and the bias at u: N. */
static inline float sp_hammerstein_force(const sp_hammerstein_config *config,
                                           const sp_hammerstein_tables *tables, float u,
                                           sp_curve_place place, const float *held, float *play)
{
    const float still_n = sp_hammerstein_still(config, tables, u, place, play);
    return still_n + sp_hammerstein_held(held, config->n_branches);
}

/* ----------------------------------------------------------------------------------- sp_poles.h */

/* Poles: h' = g' - h/tau for many tau at once, with g linear within a step (exact at any rate):
 *
 *     h[n] = exp(-dt/tau) h[n-1] + gain (g[n] - g[n-1])
 *
 * loss = 1 - exp(-dt/tau); the gain, tau/dt (1 - exp(-dt/tau)), is folded into what is read off h
 * or put into g. At rest h is 0, so that a start in equilibrium needs no history. */

static inline float sp_poles_next(float h, float loss, float rise)
{
    return sp_flushed(h + (rise - loss * h));
}

/* Each pole has an input of its own: g now, `before` at the last tick. */
static inline void sp_poles_apart(const float *loss, uint32_t n_poles, const float *g,
                                  float *before, float *h)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        h[i] = sp_poles_next(h[i], loss[i], g[i] - before[i]);
        before[i] = g[i];
    }
}

/* --------------------------------------------------------------------------------- sp_surface.h */

/* The surface of an object that lets go: it recovers more slowly than a tool can leave.
 *
 * A model that is pressed along the tool's way would pull. An object does not: from where its force
 * is 0 on, the tool has left it, and its surface comes back by itself. So the model is moved to
 *
 *     u = max(tool, surface),   surface = where its force is 0
 *
 * and gives no force while the tool is above. From tick to tick the surface comes back as far as
 * the force of the last tick allows at the stiffest that each piece of the depth can be: the model
 * does not pull on the way, and what is left of the force moves it in the next tick. No work is
 * done, and stored energy falls (docs/explanation/model.md). */

/* Where the surface comes back to from `from` under force_n. stiffest: [n_pieces], N a piece. */
static inline float sp_surface_back(const float *stiffest, uint32_t n_pieces, float from,
                                      float force_n)
{
    sp_curve_place place = sp_curve_at(from, n_pieces);
    float left_n = force_n;
    float takes_n = stiffest[place.piece] * place.way;
    while (place.piece > 0 && left_n > takes_n) {
        left_n -= takes_n;
        place.piece--;
        place.way = (float)1;
        takes_n = stiffest[place.piece];
    }
    const float way = place.way - left_n / stiffest[place.piece];
    const float end = (float)place.piece + (way > (float)0 ? way : (float)0);
    const float per_piece = (float)(n_pieces > 1u ? n_pieces - 1u : 1u);
    return end / per_piece;
}

/* Where the model is while the tool is at u. */
static inline float sp_surface_at(const float *stiffest, uint32_t n_pieces,
                                    const sp_surface_state *state, float u)
{
    if (!(u < state->u)) {
        return u;
    }
    if (!(state->force_n > (float)0)) {
        return state->u;
    }
    const float found = sp_surface_back(stiffest, n_pieces, state->u, state->force_n);
    const float surface = found < state->u ? found : state->u; /* but for rounding, found */
    return u > surface ? u : surface;
}

/* --------------------------------------------------------------------------- sp_tool_velocity.h */

/* Velocity of the tool for a coupling: the difference of positions behind a first-order low-pass.
 * Its lag is the same at every speed, so that the loop's stability can be computed; adaptive
 * windows lag most on the small motions of a hold, where a coupling's damper is needed. */

static inline void sp_tool_velocity_rest(sp_tool_velocity_state *state, float x)
{
    state->position_m = x;
    state->velocity_mps = (float)0;
}

/* rate_hz: of the ticks; weight: of the newest difference, dt/(dt + time constant). */
static inline float sp_tool_velocity(sp_tool_velocity_state *state, float rate_hz,
                                       float weight, float x)
{
    const float difference_mps = (x - state->position_m) * rate_hz;
    state->position_m = x;
    state->velocity_mps =
        sp_flushed(state->velocity_mps + weight * (difference_mps - state->velocity_mps));
    return state->velocity_mps;
}

/* --------------------------------------------------------------------------------- sp_contact.h */

/* Contact and onset: no force at or above the surface, and a force that rises from 0 over the
 * first `onset_m` of depth (a forest is not 0 at 0). */

static inline float sp_contact_onset(float per_onset, float x, float force_n)
{
    const float share = x * per_onset;
    if (!(share > (float)0)) {
        return (float)0;
    }
    return share < (float)1 ? force_n * share : force_n;
}

/* ---------------------------------------------------------------------------------- sp_couple.h */

/* Virtual coupling (the paper's figure 12c, Algorithm 1): the model's force moves a proxy, which a
 * spring and a damper tie to the tool:
 *
 *     m a_p = -f_M - k (x_p - x) - b (v_p - v)      positions into the object, f_M >= 0 pushing out
 *     force = k (x - x_p) + b (v - v_p)             positive outward
 *
 * The paper computes f_M at the tool. Computed at the proxy instead (sp_couple_place), what the
 * loop must render is the coupling in series with the object: never stiffer than k.
 *
 * Stepped exactly instead of by Euler: with e = x_p - x and w = v_p - v, and the tool moving at v
 * within the step, (e + f_M/k, w) is multiplied by the matrix exponential `phi`. Stable for every
 * positive stiffness, damping and mass.
 *
 * A sum rounds by its order: terms are added from left to right, those in parentheses first, the
 * tool's own motion before the proxy's way relative to it. The numpy reference adds in this order,
 * and no flag may let a compiler choose another. */

typedef struct {
    float stiffness_npm;
    float damping_nspm;
    float compliance_mpn; /* 1/k */
    float dt_s;
    float phi[4]; /* exp([[0, 1], [-k/m, -b/m]] dt), row by row */
} sp_couple_config;

static inline void sp_couple_release(sp_couple_state *state)
{
    state->set = 0;
}

/* The proxy exists from here on; returns where it is, m. */
static inline float sp_couple_place(sp_couple_state *state, float x, float v)
{
    if (!state->set) {
        /* At the tool's velocity: from rest there would be a kick of b v. */
        state->proxy_m = x;
        state->proxy_mps = v;
        state->set = 1;
    }
    return state->proxy_m;
}

/* Returns the force felt at the tool, N, from the proxy as it is; then moves the proxy. */
static inline float sp_couple_force(const sp_couple_config *config, sp_couple_state *state,
                                      float x, float v, float model_n)
{
    const float e = state->proxy_m - x;
    const float w = state->proxy_mps - v;
    const float force_n = -(config->stiffness_npm * e) - config->damping_nspm * w;
    const float rest = -(config->compliance_mpn * model_n);
    const float from_rest = e - rest;
    const float *phi = config->phi;
    state->proxy_m = sp_bounded(x + config->dt_s * v + (rest + (phi[0] * from_rest + phi[1] * w)));
    state->proxy_mps = sp_bounded(v + (phi[2] * from_rest + phi[3] * w));
    return force_n;
}

/* ---------------------------------------------------------------------------------- sp_output.h */

/* Output: the last word on the force.
 *
 * Down at once: a force that the model lowers is lower in the same tick. Up by two limits: never
 * more than slew_n above the force that was given before, whatever the reason that it was less; and
 * after a start at depth, or a silence, by a share of the model's force that rises to 1. Without a
 * sample the force never rises; latched, it falls to zero and stays there.
 * docs/explanation/output.md has the equations. */

typedef struct {
    float min_n;
    float max_n;
    float slew_n; /* maximum growth of the force from call to call: a fault's, not a touch's */
    float rise;   /* share of the force gained in a tick after a start or restart at depth */
    float back;   /* the same after a silence */
    float fall_n; /* of the force in one tick once it is latched */
} sp_output_config;

/* A position was taken as true without a history: the force rises from zero. */
static inline void sp_output_restart(const sp_output_config *config, sp_output_state *state)
{
    state->share = (float)0;
    state->rise = config->rise;
}

/* No contact: whatever comes next starts from zero by itself. */
static inline void sp_output_free(sp_output_state *state)
{
    state->share = (float)1;
}

/* What is not within the scene's limits; a NaN compares with nothing: it becomes 0. */
SP_RARE float sp_output_cut(const sp_output_config *config, float force_n, int *notes)
{
    *notes |= SP_NOTE_CLAMPED;
    return force_n > config->max_n   ? config->max_n
           : force_n < config->min_n ? config->min_n
                                     : (float)0;
}

/* Within the scene's limits. */
static inline float sp_output_clamp(const sp_output_config *config, float force_n, int *notes)
{
    if (force_n >= config->min_n && force_n <= config->max_n) {
        return force_n;
    }
    return sp_output_cut(config, force_n, notes);
}

/* Latched, for so many ticks; from within the limits, whatever a stray write made of given_n. */
SP_RARE float sp_output_fall(const sp_output_config *config, sp_output_state *state,
                               float ticks, int *notes)
{
    const float given_n = sp_output_clamp(config, state->given_n, notes);
    const float step = config->fall_n * ticks;
    const float down_n = given_n - step;
    const float up_n = given_n + step;
    state->given_n = down_n > (float)0 ? down_n : up_n < (float)0 ? up_n : (float)0;
    *notes |= SP_NOTE_LATCHED;
    return state->given_n;
}

/* The force given before, as far as it has the direction of `force_n`. */
static inline float sp_output_before(const sp_output_state *state, float force_n)
{
    const float zero = (float)0;
    const float given_n = state->given_n;
    if (force_n > zero) {
        return given_n > zero ? given_n : zero;
    }
    return given_n < zero ? given_n : zero;
}

/* First good sample after a silence: the share rises from what was given to the model's force. A
 * ramp that was under way goes on as slowly. */
SP_RARE void sp_output_resume(const sp_output_config *config, sp_output_state *state,
                              float force_n)
{
    const float before_n = sp_abs(sp_output_before(state, force_n));
    const float now_n = sp_abs(force_n);
    const float share = before_n < now_n ? before_n / now_n : (float)1;
    if (share < (float)1 && share < state->share) {
        state->rise = state->share < (float)1 ? state->rise : config->back;
        state->share = share + state->rise;
    }
}

/* The model's force of a good sample; returns what leaves, N. after_silence: ticks before it had no
 * good sample. ticks: of this call, at most 1. */
static inline float sp_output_force(const sp_output_config *config, sp_output_state *state,
                                      int after_silence, float ticks, float force_n, int *notes)
{
    if (after_silence) {
        sp_output_resume(config, state, force_n);
    }
    if (state->share < (float)1) {
        force_n *= state->share;
        state->share += state->rise * ticks;
        *notes |= SP_NOTE_RAMPED;
    }
    force_n = sp_output_clamp(config, force_n, notes);
    const float slew_n = config->slew_n * ticks;
    const float before_n = sp_output_before(state, force_n);
    const float upper_n = before_n + slew_n;
    const float lower_n = before_n - slew_n;
    if (force_n > (float)0) {
        if (force_n > upper_n) {
            *notes |= SP_NOTE_LIMITED;
            force_n = upper_n;
        }
    } else if (force_n < lower_n) {
        *notes |= SP_NOTE_LIMITED;
        force_n = lower_n;
    }
    state->given_n = force_n;
    return force_n;
}

/* ---------------------------------------------------------------------- constants of this scene */

static const sp_silence_config silence = {
    0.001f,  /* dt_s */
    1000.0f, /* per_dt */
    0.0205f, /* watchdog_s */
};
static const sp_guard_config guard = {
    0.0014693231f, /* jump_m */
    -10.0f,        /* min_m */
    0.119984604f,  /* max_m */
    5,             /* resync_ticks */
};
static const sp_range_config range = {
    0.0f,         /* min_m */
    0.011998461f, /* max_m */
};
static const sp_output_config output = {
    0.0f,       /* min_n */
    10.955592f, /* max_n */
    2.738898f,  /* slew_n */
    0.02f,      /* rise */
    0.1f,       /* back */
    1.369449f,  /* fall_n */
};
static const sp_couple_config couple = {
    1500.0f,                                              /* stiffness_npm */
    20.0f,                                                /* damping_nspm */
    0.00066666666f,                                       /* compliance_mpn */
    0.001f,                                               /* dt_s */
    {0.98684704f, 0.000820096f, -24.60288f, 0.65880865f}, /* phi */
};
static const float per_onset = 8334.402f;

/* Curves: values and slopes at the nodes, a column a branch (sp_curve.h). */
static const float spring[20] = {
    0.0f, 0.41273984f, 0.5010738f, 0.58940774f, 1.1820204f, 0.77248544f, 2.044955f, 0.9533838f,
    3.08545f, 1.1276062f, 4.303316f, 1.3081261f, 5.703667f, 1.492576f, 7.28427f, 1.6686296f,
    9.0454645f, 1.8537602f, 9.0454645f, 1.8537602f
};
static const float branches[20 * 4] = {
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.04441721f, 0.01903994f, 0.017259978f, 0.004970012f,
    0.032855902f, 0.019350037f, 0.034519956f, 0.009940024f, 0.02129459f, 0.019660132f, 0.06891983f,
    0.018816372f, 0.04720332f, 0.042240627f, 0.06879976f, 0.017752698f, 0.0074002524f, 0.026121046f,
    0.1536101f, 0.03549022f, 0.05118135f, 0.07128427f, 0.10058078f, 0.0155949965f, 0.0005558048f,
    0.03196625f, 0.26837456f, 0.047015693f, 0.051459253f, 0.10412984f, 0.12894815f, 0.0074559497f,
    0.0f, 0.033724878f, 0.40947756f, 0.050967585f, 0.051459253f, 0.13745369f, 0.15325786f,
    0.0004478369f, 0.0f, 0.03292283f, 0.5730301f, 0.051191505f, 0.051459253f, 0.16970202f,
    0.17384727f, 0.0f, 0.0f, 0.031573843f, 0.75608265f, 0.051191505f, 0.051459253f, 0.19963248f,
    0.19225769f, 0.0f, 0.0f, 0.028287059f, 0.9572059f, 0.051191505f, 0.051459253f, 0.22618717f,
    0.20998879f, 0.0f, 0.0f, 0.024822311f, 0.9572059f, 0.051191505f, 0.051459253f, 0.22618717f,
    0.20998879f, 0.0f, 0.0f, 0.024822311f
};
static const float branch_loss[4] = {
    0.39346933f, 0.07317967f, 0.0114841955f, 0.006145274f
};
/* At most so stiff is each piece of the depth, N a piece (sp_surface.h). */
static const float stiffest[9] = {
    0.6748225f, 0.89255923f, 1.1020818f, 1.2977352f, 1.4947548f, 1.6979972f, 1.8891745f, 2.0885715f,
    2.0885715f
};
static const float stops[1 * 20] = {
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.003419151f, 0.006838302f,
    0.015024306f, 0.016372008f, 0.032539934f, 0.018659245f, 0.050479703f, 0.017220294f, 0.050479703f,
    0.017220294f
};
static const float stop_radius[1] = {
    0.5f
};
static const sp_hammerstein_config passive = {
    2.3093101e-07f, /* origin_m */
    83.34563f,      /* per_span */
    0.0f,           /* bias_n */
    9,              /* n_pieces */
    4,              /* n_branches */
    1,              /* n_stops */
};
static const sp_hammerstein_tables passive_tables = {
    spring,      /* spring */
    branches,    /* branches */
    stops,       /* stops */
    stop_radius, /* radius */
};

static const float rate_hz = 1000.0f;
static const float velocity_weight = 0.2f;

/* ---------------------------------------------------- the tick, and the functions of the header */

/* A position is true without a history: the object has rested there for ever. */
static void restart(sp_state *state, float position)
{
    const float penetration = position > (float)0 ? position : (float)0;
    const float penetration_u = sp_hammerstein_share(&passive, penetration);
    sp_hammerstein_rest(&passive, &passive_tables, penetration_u,
                        state->penetration_before, state->penetration_held, state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = (float)0;
    sp_tool_velocity_rest(&state->tool_velocity, position);
    sp_couple_release(&state->couple);
    sp_output_restart(&output, &state->output);
}

/* One tick with the tool at `position`; returns the model's force, N. */
SP_APART float tick(sp_state *state, float position, int *notes)
{
    const float position_mps =
        sp_tool_velocity(&state->tool_velocity, rate_hz, velocity_weight, position);
    const float proxy =
        position > (float)0 ? sp_guard_within(&guard, sp_couple_place(&state->couple, position, position_mps)) : position;
    const float penetration = proxy > (float)0 ? proxy : (float)0;
    (void)sp_range_clip(&range, penetration, notes);
    const float penetration_tool = sp_hammerstein_share(&passive, penetration);
    const float penetration_u =
        sp_surface_at(stiffest, passive.n_pieces, &state->penetration_surface, penetration_tool);
    const sp_curve_place penetration_place = sp_curve_at(penetration_u, passive.n_pieces);
    float penetration_branch[4];
    sp_curve(branches, 4, penetration_place, penetration_branch);
    sp_poles_apart(branch_loss, 4,
        penetration_branch, state->penetration_before, state->penetration_held);
    const float penetration_held_n =
        sp_hammerstein_force(&passive, &passive_tables, penetration_u, penetration_place,
                             state->penetration_held, state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = penetration_held_n;
    const float penetration_passive_n =
        penetration_held_n > (float)0 && !(penetration_u > penetration_tool) ? penetration_held_n : (float)0;
    float force = (float)0;
    if (position > (float)0) {
        force = penetration_passive_n;
        force = sp_contact_onset(per_onset, proxy, force);
        force = sp_couple_force(&couple, &state->couple, position, position_mps, force);
    } else {
        sp_couple_release(&state->couple);
        sp_output_free(&state->output);
    }
    return force;
}

/* dt_s have passed without a good sample; share: of the force that may be felt. */
static int hold(sp_state *state, float dt_s, float share, float *force_n)
{
    int notes = SP_NOTE_HELD;
    const float latched = sp_silence_passed(&silence, &state->silence, dt_s);
    float given_n = share * sp_output_clamp(&output, state->output.given_n, &notes);
    state->output.given_n = given_n;
    if (state->silence.latched) {
        notes = 0;
        given_n = sp_output_fall(&output, &state->output, latched, &notes);
    }
    *force_n = given_n;
    return notes;
}

/* The `left` ticks without a sample before this one, a step each. */
SP_RARE void make_up(sp_state *state, float position, float step,
                     float ticks, uint32_t left)
{
    /* At a constant acceleration from the velocity before: the damper would feel a kink. */
    const float begin = state->tool_velocity.velocity_mps * silence.dt_s;
    const float bend = (step - begin) / ticks;
    for (; left > 0; left--) {
        const float curve = bend * (ticks - (float)left);
        const float way = (float)left * (step + curve);
        const float at = sp_guard_within(&guard, position - way);
        int ignored = 0;
        (void)tick(state, at, &ignored);
    }
}

int sp_step(sp_state *state, float position_m, float velocity_mps, float *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_GUARD_BEGUN) {
        return SP_ERROR_STATE;
    }
    uint32_t left = 0;
    float ticks = (float)1;
    if (state->silence.silent_s > (float)0) {
        left = sp_silence_missed(&silence, &state->silence, silence.dt_s);
        ticks = (float)(left + 1);
    }
    (void)velocity_mps;
    int notes = 0;
    const float before = state->guard.good_m;
    const float position =
        sp_guard_position(&guard, &state->guard, ticks, position_m, &notes);
    if (notes & SP_NOTE_HELD) {
        return hold(state, silence.dt_s, sp_guard_share(&guard, &state->guard, position_m), force_n);
    }
    sp_silence_heard(&state->silence, silence.dt_s);
    float way = position - before;
    if (notes & SP_NOTE_RESYNC) {
        restart(state, position);
        left = 0;
        ticks = (float)1;
        way = (float)0;
    }
    if (left > 0) {
        make_up(state, position, way / ticks, ticks, left);
    }
    const float force = tick(state, position, &notes);
    if (state->silence.latched) {
        (void)sp_output_fall(&output, &state->output, (float)1, &notes);
    } else {
        (void)sp_output_force(&output, &state->output, left > 0, (float)1, force, &notes);
    }
    *force_n = state->output.given_n;
    return notes;
}

int sp_run(sp_state *state, uint32_t n, const float *position_m, const float *velocity_mps,
           float *force_n)
{
    if (state == NULL || position_m == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    (void)velocity_mps;
    int notes = 0;
    for (uint32_t i = 0; i < n; i++) {
        notes |= sp_step(state, position_m[i], (float)0, &force_n[i]);
    }
    return notes;
}

int sp_idle(sp_state *state, float dt_s, float *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_GUARD_BEGUN) {
        return SP_ERROR_STATE;
    }
    if (!sp_is_time(dt_s)) {
        return SP_ERROR_TIME_STEP;
    }
    return hold(state, dt_s, (float)1, force_n);
}

void sp_init(sp_state *state)
{
    if (state != NULL) {
        (void)memset(state, 0, sizeof *state);
        state->begun = SP_GUARD_BEGUN;
    }
}

void sp_reset(sp_state *state)
{
    sp_init(state);
}

uint32_t sp_abi_version(void)
{
    return 1;
}

uint32_t sp_state_size(void)
{
    return (uint32_t)sizeof(sp_state);
}

const char *sp_manifest(void)
{
    return "{\"springpot\": \"0.1.0\", \"hash\": \"a7122c28fa44c3648795efa195622124d636a7f71f31c0013c1aaf91f1a725a8\", \"scene\": \"proxy\", \"model\": \"hammerstein\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [2.3093100251531682e-07, 0.011998460459983215], \"speed_mps\": 0.18366538639667027, \"force_n\": [-7.121525591458066e-15, 9.129659751043853]}}";
}

/* ------------------------------------------------------------------------------------ self-test */

