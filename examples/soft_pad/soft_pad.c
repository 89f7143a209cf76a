/* springpot 0.1.0 6152aa5b2c6b1ceb25570421c93982d95cb888eee53319afc2d2078d0c71550a */
/* pad: the whole scene with its self-test. soft_pad.h says how to call it.
 *
 * First the units, in the order of a tick: each is named by its file in springpot, without the
 * functions that this scene does not call. Then the constants of this scene, the tick, the
 * functions of the header, and the self-test. */
#include "soft_pad.h"

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
typedef char soft_pad_int_is_as_planned[sizeof(int) >= 4 ? 1 : -1];

/* ------------------------------------------------------------------------------------ sp_real.h */

#define SOFT_PAD_REAL_MAX FLT_MAX

/* Instructions with every FPU: no library is called. */
#define soft_pad_abs(x) fabsf(x)
#define soft_pad_sqrt(x) sqrtf(x)

/* ---------------------------------------------------------------------------------- sp_number.h */

/* Number helpers that the units share. */

#if defined(__FAST_MATH__) || defined(_M_FP_FAST) ||                                               \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0)
#error                                                                                             \
    "springpot needs IEEE arithmetic: build without -ffast-math, -ffinite-math-only"
#endif

/* SOFT_PAD_COLD: rarely called, kept out of line. SOFT_PAD_NOINLINE: long and called twice; inlining it would
 * stop the compiler from inlining inside it. */
#if defined(__GNUC__)
#define SOFT_PAD_COLD __attribute__((noinline, cold, unused)) static
#define SOFT_PAD_NOINLINE __attribute__((noinline)) static
#else
#define SOFT_PAD_COLD static inline
#define SOFT_PAD_NOINLINE static
#endif

/* Returns 1 if x is a length of time: positive, finite, not NaN. Without libm. */
static inline int soft_pad_is_valid_dt(float x)
{
    return x == x && x > 0.0f && x <= SOFT_PAD_REAL_MAX;
}

/* Smaller values become 0: on some processors a denormal takes a hundred times as long as other
 * numbers. */
#define SOFT_PAD_FLUSH_BELOW_DOUBLE 1e-30
#define SOFT_PAD_FLUSH_BELOW ((float)SOFT_PAD_FLUSH_BELOW_DOUBLE)

static inline float soft_pad_flush_denormal(float x)
{
    return soft_pad_abs(x) < SOFT_PAD_FLUSH_BELOW ? 0.0f : x;
}

/* Bound of every model state, far above any real value. It lets the static analyser prove finite
 * states where one step alone gives no bound (a measured time step, a mass on a spring). NaN does
 * not come here, as the analyser shows; it would become the largest value. */
#define SOFT_PAD_MAX_STATE 1e6

static inline float soft_pad_clamp_state(float x)
{
    const float below = x < (float)SOFT_PAD_MAX_STATE ? x : (float)SOFT_PAD_MAX_STATE;
    return below > (float)-SOFT_PAD_MAX_STATE ? below : (float)-SOFT_PAD_MAX_STATE;
}

/* --------------------------------------------------------------------------------- sp_silence.h */

/* Silence watchdog: counts the time without a good sample, and latches when it is too long.
 *
 * After a short gap the next good sample moves every filter through the missed ticks, as if the
 * tool had moved evenly. Gaps that add up latch as well, by a leaky bucket of five timeouts: each
 * silent tick puts one tick of debt in, each good tick takes 5/32 of a tick out. A source that is
 * silent for more than a seventh of the time therefore latches: in half a second if for a third. */

typedef struct {
    float dt_s;       /* sample time */
    float rate_hz;    /* 1 / dt_s */
    float watchdog_s; /* watchdog timeout plus half a tick, so that rounded sums agree on it */
} soft_pad_silence_config;

/* Ticks of debt that one good tick pays back. */
#define SOFT_PAD_SILENCE_PAYBACK (0.15625f)

/* Debt that latches, in watchdog timeouts. With one alone, a source that lost 1 % of its samples in
 * bursts of 14 ms latched every few minutes, though no silence reached the timeout. */
#define SOFT_PAD_SILENCE_MAX_DEBT (5.0f)

/* Cap on the latched ticks that one call reports: the force is zero long before. It keeps the
 * conversion to uint32_t in range for an infinite dt_s. */
#define SOFT_PAD_SILENCE_MAX_LATCHED_TICKS (1048576.0f)

/* Record a good sample that stands for dt_s of time. */
static inline void soft_pad_silence_good_sample(soft_pad_silence_state *state, float dt_s)
{
    state->silent_s = 0.0f;
    if (state->debt_s > 0.0f) {
        state->debt_s -= SOFT_PAD_SILENCE_PAYBACK * dt_s;
    }
}

/* Count dt_s without a good sample, and latch the watchdog where one silence is too long, or
 * too much of the time is silent (a debt that good samples pay off). Returns for how many ticks
 * of dt_s it was latched. */
static inline float soft_pad_silence_no_sample(const soft_pad_silence_config *config,
                                               soft_pad_silence_state *state, float dt_s)
{
    const float ticks = dt_s * config->rate_hz;
    if (state->latched) {
        return ticks;
    }
    const float silent_s = state->silent_s + dt_s;
    const float debt_s = (state->debt_s > 0.0f ? state->debt_s : 0.0f) + dt_s;
    const float max_debt_s = SOFT_PAD_SILENCE_MAX_DEBT * config->watchdog_s;
    if (silent_s <= config->watchdog_s && debt_s <= max_debt_s) {
        state->silent_s = silent_s;
        state->debt_s = debt_s;
        return 0.0f;
    }
    const float silent_overrun_s = silent_s - config->watchdog_s;
    const float debt_overrun_s = debt_s - max_debt_s;
    const float overrun_s = silent_overrun_s > debt_overrun_s ? silent_overrun_s : debt_overrun_s;
    const float overrun = overrun_s > 0.0f ? overrun_s * config->rate_hz : 0.0f;
    const float capped =
        overrun < SOFT_PAD_SILENCE_MAX_LATCHED_TICKS ? overrun : SOFT_PAD_SILENCE_MAX_LATCHED_TICKS;
    const float latched_ticks = (float)((uint32_t)capped + 1u);
    state->latched = 1;
    state->silent_s = 0.0f;
    state->debt_s = 0.0f;
    return latched_ticks < ticks ? latched_ticks : ticks;
}

/* Whole ticks that were missed before a sample that stands for dt_s. The watchdog timeout
 * bounds the result even if a stray write has corrupted the state, so that catching up always
 * ends. */
static inline uint32_t soft_pad_silence_missed_ticks(const soft_pad_silence_config *config,
                                               const soft_pad_silence_state *state, float dt_s)
{
    const float max_s = config->watchdog_s;
    const float silent_s = state->silent_s < max_s ? state->silent_s : max_s;
    const float ticks = (silent_s + dt_s) * config->rate_hz;
    return ticks >= 1.5f ? (uint32_t)(ticks - 0.5f) : 0;
}

/* ----------------------------------------------------------------------------------- sp_guard.h */

/* Input guard: rejects implausible positions and holds the last good one.
 *
 * A sample is implausible if it is not finite, outside [min_m, max_m], or further from the last
 * good one than a hand can have moved since. Denormals become 0. After `resync_ticks` samples in a
 * row that agree with each other the guard accepts the new position and restarts the history, so
 * that a sensor that jumped once does not hold the force for ever. */

typedef struct {
    float max_step_m;    /* largest plausible step, m a tick */
    float min_m;         /* smallest plausible position */
    float max_m;         /* largest plausible position */
    float air_m;         /* any step is plausible between positions at or below this one */
    uint32_t resync_ticks; /* agreeing samples after which a new position is accepted */
} soft_pad_guard_config;

/* Magic number that soft_pad_init writes; soft_pad_step refuses a state without it. */
#define SOFT_PAD_STATE_MAGIC 0x5b9a3c1fu

static inline int soft_pad_guard_plausible(const soft_pad_guard_config *config, float x)
{
    return x == x && x >= config->min_m && x <= config->max_m; /* false for NaN */
}

/* Clamp a computed position (proxy, missed tick) to the plausible range. */
static inline float soft_pad_guard_clamp(const soft_pad_guard_config *config, float x)
{
    const float below = x < config->max_m ? x : config->max_m;
    return below > config->min_m ? below : config->min_m;
}

/* Accept or reject the sample x. ticks: since the last good sample. Returns the position to use, m;
 * 0 before the first plausible sample. */
static inline float soft_pad_guard_accept(const soft_pad_guard_config *config,
                                          soft_pad_guard_state *state, float ticks, float x,
                                          int *notes)
{
    x = soft_pad_flush_denormal(x);
    if (!soft_pad_guard_plausible(config, x)) {
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
    if (soft_pad_abs(x - state->last_good_m) <= config->max_step_m * ticks ||
        (x <= config->air_m && state->last_good_m <= config->air_m)) {
        state->agreeing_samples = 0;
        state->last_good_m = x;
        return x;
    }
    const int agrees =
        state->agreeing_samples && soft_pad_abs(x - state->candidate_m) <= config->max_step_m;
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
static inline float soft_pad_guard_held_fraction(const soft_pad_guard_config *config,
                                             const soft_pad_guard_state *state, float x)
{
    x = soft_pad_flush_denormal(x);
    if (!soft_pad_guard_plausible(config, x)) {
        return 1.0f;
    }
    if (!(x > 0.0f)) {
        return 0.0f;
    }
    const float fraction = x < state->last_good_m ? x / state->last_good_m : 1.0f;
    return fraction < 1.0f ? fraction : 1.0f;
}

/* ----------------------------------------------------------------------------------- sp_range.h */

/* Trained range: clips the depth for models that cannot extrapolate. */

typedef struct {
    float min_m;
    float max_m;
} soft_pad_range_config;

/* Position within the range of training, m; beyond it the nearest end, with a note. */
static inline float soft_pad_range_clip(const soft_pad_range_config *config, float x, int *notes)
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

/* Smooth curves of the normalised depth u.
 *
 * u is 0 at the lowest trained position and 1 at the last node. Each curve has a value and a slope
 * at equally spaced nodes from 0 to 1, is a parabola between two nodes, and straight beyond the
 * last one. A curve whose slopes are all >= 0 never falls. */

typedef struct {
    uint32_t interval;
    float fraction; /* of the interval, 0 .. 1; above 1 beyond the last node */
} soft_pad_curve_position;

/* Find the interval that holds u. Below 0 curves are constant; the last interval extends beyond the
 * last node. */
static inline soft_pad_curve_position soft_pad_curve_locate(float u, uint32_t n_intervals)
{
    const float n_per_u = (float)(n_intervals > 1u ? n_intervals - 1u : 1u);
    const float last = (float)(n_intervals - 1u);
    const float steps = u > 0.0f ? u * n_per_u : 0.0f;
    const uint32_t interval = steps < last ? (uint32_t)steps : n_intervals - 1u;
    const soft_pad_curve_position place = {interval, steps - (float)interval};
    return place;
}

/* Evaluate n_curves curves. nodes: [n_intervals + 1][2][n_curves], values and slopes per interval;
 * the last slope repeats. values: [n_curves]. */
static inline void soft_pad_curve(const float *nodes, uint32_t n_curves,
                                  soft_pad_curve_position place, float *values)
{
    const float *value = nodes + place.interval * 2 * n_curves;
    const float *slope = value + n_curves;
    const float *next = slope + 2 * n_curves;
    const float half = 0.5f * place.fraction;
    for (uint32_t i = 0; i < n_curves; i++) {
        values[i] = value[i] + place.fraction * (slope[i] + half * (next[i] - slope[i]));
    }
}

/* ----------------------------------------------------------------------------------- sp_stops.h */

/* Stop operators (Prandtl-Ishlinskii): P(u) - P(p). The play p follows u and stays within `radius`
 * of it. The loss does not depend on the rate; with a P that never falls no energy is gained. */

static inline float soft_pad_stops_play(float play, float u, float radius)
{
    const float low = u - radius;
    const float high = u + radius;
    const float raised = play > low ? play : low;
    return raised < high ? raised : high;
}

/* ----------------------------------------------------------------------------- sp_hammerstein.h */

/* Hammerstein model: a spring, Maxwell branches and stop operators. Each has a curve of the depth
 * that never falls:
 *
 *     force = bias + spring(u) + sum over branches of highpass(g_i(u)) + sum over stops
 *
 * Every weight is non-negative and every pole real, so that the force is passive: a closed
 * press takes at least as much energy as it returns. A stop is P(u) - P(play); P(u) is part of the
 * spring's curve. Within a tick the branches (sp_poles.h, sp_poles_by_depth.h) advance after their
 * curves are read at u, and before their forces are summed here. */

/* On targets with vector units n_branches is a multiple of it. */
enum { SOFT_PAD_HAMMERSTEIN_LANES = 4 };

typedef struct {
    float origin_m;
    float u_per_m; /* 1/m */
    float bias_n;
    uint32_t n_intervals;
    uint32_t n_branches;
    uint32_t n_stops;
} soft_pad_hammerstein_config;

/* Constant tables of the scene. Curves as in sp_curve.h, N. */
typedef struct {
    const float *spring;   /* one curve */
    const float *branches; /* n_branches curves */
    const float *stops;    /* one curve for each stop */
    const float *radius;   /* [n_stops], in u */
} soft_pad_hammerstein_tables;

/* Normalised depth of x, m. */
static inline float soft_pad_hammerstein_u(const soft_pad_hammerstein_config *config, float x)
{
    return (x - config->origin_m) * config->u_per_m;
}

/* Set the state of an object that has rested at u for a long time: every branch has relaxed.
 * before, held: [n_branches]; play: [n_stops]. */
static inline void soft_pad_hammerstein_rest(const soft_pad_hammerstein_config *config,
                                       const soft_pad_hammerstein_tables *tables, float u,
                                       float *before, float *held, float *play)
{
    soft_pad_curve(tables->branches, config->n_branches, soft_pad_curve_locate(u,
                                                                               config->n_intervals),
                   before);
    for (uint32_t i = 0; i < config->n_branches; i++) {
        held[i] = 0.0f;
    }
    for (uint32_t k = 0; k < config->n_stops; k++) {
        play[k] = u;
    }
}

/* Rate-independent force at u: spring, stops and bias, N. Updates the stops' plays. */
static inline float soft_pad_hammerstein_static_force(const soft_pad_hammerstein_config *config,
                                                      const soft_pad_hammerstein_tables *tables,
                                                      float u, soft_pad_curve_position place,
                                                      float *play)
{
    float static_n;
    soft_pad_curve(tables->spring, 1, place, &static_n);
    static_n += config->bias_n;
    for (uint32_t k = 0; k < config->n_stops; k++) {
        const float *stop = tables->stops + k * (config->n_intervals + 1) * 2;
        float stop_n;
        play[k] = soft_pad_stops_play(play[k], u, tables->radius[k]);
        soft_pad_curve(stop, 1, soft_pad_curve_locate(play[k], config->n_intervals), &stop_n);
        static_n -= stop_n;
    }
    return static_n;
}

/* Sum of the branch forces: four partial sums in one fixed order, so that bits do not depend on
 * vector units. */
static inline float soft_pad_hammerstein_branch_sum(const float *held, uint32_t n_branches)
{
    float sum[SOFT_PAD_HAMMERSTEIN_LANES] = {0};
    const uint32_t whole = n_branches - n_branches % SOFT_PAD_HAMMERSTEIN_LANES;
    for (uint32_t i = 0; i < whole; i += SOFT_PAD_HAMMERSTEIN_LANES) {
#pragma GCC unroll 4
        for (uint32_t k = 0; k < SOFT_PAD_HAMMERSTEIN_LANES; k++) {
            sum[k] += held[i + k];
        }
    }
#pragma GCC unroll 4
    for (uint32_t i = whole; i < n_branches; i++) {
        sum[i - whole] += held[i];
    }
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/* Force at u, N: branch forces `held` of this tick, spring, stops and bias. */
static inline float soft_pad_hammerstein_force(const soft_pad_hammerstein_config *config,
                                           const soft_pad_hammerstein_tables *tables, float u,
                                           soft_pad_curve_position place, const float *held,
                                           float *play)
{
    const float static_n = soft_pad_hammerstein_static_force(config, tables, u, place, play);
    return static_n + soft_pad_hammerstein_branch_sum(held, config->n_branches);
}

/* ----------------------------------------------------------------------------------- sp_poles.h */

/* Poles: h' = g' - h/tau for many tau at once, with g linear within a step (exact at any rate):
 *
 *     h[n] = exp(-dt/tau) h[n-1] + gain (g[n] - g[n-1])
 *
 * loss = 1 - exp(-dt/tau). The gain, tau/dt (1 - exp(-dt/tau)), is folded into the weights of h or
 * into g. At rest h is 0, so that a start in equilibrium needs no history. */

static inline float soft_pad_poles_step(float h, float loss, float rise)
{
    return soft_pad_flush_denormal(h + (rise - loss * h));
}

/* Advance Maxwell branches that have an input each: its elastic force g now, `before` at the
 * last tick. */
static inline void soft_pad_poles_separate(const float *loss, uint32_t n_poles, const float *g,
                                     float *before, float *h)
{
    for (uint32_t i = 0; i < n_poles; i++) {
        h[i] = soft_pad_poles_step(h[i], loss[i], g[i] - before[i]);
        before[i] = g[i];
    }
}

/* ----------------------------------------------------------------------------------- sp_depth.h */

/* Poles whose rate depends on the depth: soft tissue and elastomers relax faster or slower the
 * deeper they are pressed.
 *
 *     h' = g' - r(u) h,   h[n] = h[n-1] + d - loss(u) (h[n-1] + d/2),   d = g[n] - g[n-1]
 *
 * dissipates for every r(u) > 0 (loss 0 to 1), as h relaxes towards g at the middle of the step.
 * The loss is linear between the nodes of the curves (sp_curve.h). */

/* Advance Maxwell branches whose relaxation rate depends on depth, each with an input: its
 * elastic force g now, `before` at the last tick. loss: [n_intervals + 1][n_poles], at the
 * nodes; the last row repeats. */
static inline void soft_pad_poles_by_depth(const float *loss, uint32_t n_poles,
                                           soft_pad_curve_position place, const float *g,
                                           float *before, float *h)
{
    const float *at = loss + place.interval * n_poles;
    for (uint32_t i = 0; i < n_poles; i++) {
        const float loss_at_u = at[i] + place.fraction * (at[n_poles + i] - at[i]);
        const float rise = g[i] - before[i];
        const float branch_n = soft_pad_clamp_state(h[i]);
        h[i] = soft_pad_flush_denormal(branch_n + (rise - loss_at_u * (branch_n + 0.5f * rise)));
        before[i] = g[i];
    }
}

/* --------------------------------------------------------------------------------- sp_surface.h */

/* Surface of an object that recovers more slowly than the tool leaves it.
 *
 * If the model followed the tool, it would pull the tool back. A real object lets go: where its
 * force reaches 0 the tool leaves it, and the surface recovers by itself. So the model sees
 *
 *     u = max(tool, surface),   surface = the depth at which the model's force is 0
 *
 * and renders no force while the tool is above the surface. Each tick the surface rises until the
 * last force is used up, unloaded at the upper bound of the slope: the model never pulls, and what
 * it still pushes raises the surface in the next tick. That does no work on the tool, and the
 * stored energy falls (docs/explanation/model.md). */

/* Depth to which a surface that the tool has left recovers in this tick, driven by the force
 * force_n that is left in the branches. max_slope_n: [n_intervals], upper bound of the force
 * gained in each interval, N. */
static inline float soft_pad_surface_recovered_u(const float *max_slope_n, uint32_t n_intervals,
                                             float from_u, float force_n)
{
    soft_pad_curve_position place = soft_pad_curve_locate(from_u, n_intervals);
    float remaining_n = force_n;
    float unload_n = max_slope_n[place.interval] * place.fraction;
    while (place.interval > 0 && remaining_n > unload_n) {
        remaining_n -= unload_n;
        place.interval--;
        place.fraction = 1.0f;
        unload_n = max_slope_n[place.interval];
    }
    const float fraction = place.fraction - remaining_n / max_slope_n[place.interval];
    const float end = (float)place.interval + (fraction > 0.0f ? fraction : 0.0f);
    const float n_per_u = (float)(n_intervals > 1u ? n_intervals - 1u : 1u);
    return end / n_per_u;
}

/* Depth that the model sees while the tool is at u: that of the tool, or of the surface where
 * the tool leaves faster than the surface recovers. NaN passes. */
static inline float soft_pad_surface_model_u(const float *max_slope_n, uint32_t n_intervals,
                                         const soft_pad_surface_state *state, float u)
{
    if (!(u < state->u)) {
        return u;
    }
    if (!(state->force_n > 0.0f)) {
        return state->u;
    }
    const float recovered_u =
        soft_pad_surface_recovered_u(max_slope_n, n_intervals, state->u, state->force_n);
    const float surface =
        recovered_u < state->u ? recovered_u : state->u; /* rounding may raise recovered_u */
    return u > surface ? u : surface;
}

/* --------------------------------------------------------------------------------- sp_contact.h */

/* Onset: no force at or above the surface, the model's force from 1/onset_per_m (m) of depth on,
 * and a linear rise between. A forest does not give 0 at depth 0. */

/* Scale the force by depth x near the surface, from 0 at the surface to all of it at
 * 1/onset_per_m: contact begins without a step in force. */
static inline float soft_pad_contact_onset(float onset_per_m, float x, float force_n)
{
    const float fraction = x * onset_per_m;
    if (!(fraction > 0.0f)) {
        return 0.0f;
    }
    return fraction < 1.0f ? force_n * fraction : force_n;
}

/* ---------------------------------------------------------------------------------- sp_output.h */

/* Output limiter: clamp, slew limit, start ramp, latched fall. Every force leaves through it.
 *
 * A lower force acts at once. A higher one is limited twice: it rises by at most slew_n a call, and
 * after a start at depth the ramp scales the model's force by a fraction that grows from 0 to 1.
 * Without a sample the force never rises; once latched it falls to zero and stays there.
 * docs/explanation/output.md has the equations. */

typedef struct {
    float min_n;
    float max_n;
    float slew_n; /* slew limit, N a call: faster than any touch, so it stops faults only */
    float ramp_per_tick; /* growth of the start ramp */
    float latch_fall_n;  /* fall of a latched force, N a tick */
} soft_pad_output_config;

/* After a restart at depth the force rises from zero. */
static inline void soft_pad_output_begin_ramp(soft_pad_output_state *state)
{
    state->ramp = 0.0f;
}

/* Without contact no ramp is needed: the next contact begins at zero force by itself. */
static inline void soft_pad_output_end_ramp(soft_pad_output_state *state)
{
    state->ramp = 1.0f;
}

/* Clamp a force outside the limits (rare). NaN fails both comparisons and becomes 0. */
SOFT_PAD_COLD float soft_pad_output_clamp_cold(const soft_pad_output_config *config, float force_n,
                                               int *notes)
{
    *notes |= SP_NOTE_CLAMPED;
    return force_n > config->max_n   ? config->max_n
           : force_n < config->min_n ? config->min_n
                                     : 0.0f;
}

/* Clamp the force to the scene's limits. */
static inline float soft_pad_output_clamp(const soft_pad_output_config *config, float force_n,
                                          int *notes)
{
    if (force_n >= config->min_n && force_n <= config->max_n) {
        return force_n;
    }
    return soft_pad_output_clamp_cold(config, force_n, notes);
}

/* Lower the latched force by `ticks` ticks. last_n is clamped first, in case a stray write
 * corrupted it. */
SOFT_PAD_COLD float soft_pad_output_fall_latched(const soft_pad_output_config *config,
                                                 soft_pad_output_state *state, float ticks,
                                                 int *notes)
{
    const float last_n = soft_pad_output_clamp(config, state->last_n, notes);
    const float step = config->latch_fall_n * ticks;
    const float down_n = last_n - step;
    const float up_n = last_n + step;
    state->last_n = down_n > 0.0f ? down_n : up_n < 0.0f ? up_n : 0.0f;
    *notes |= SP_NOTE_LATCHED;
    return state->last_n;
}

/* The last rendered force if it has the sign of `force_n`, else 0: from there a force may grow
 * by a step, and fall at once. */
static inline float soft_pad_output_last_along(const soft_pad_output_state *state, float force_n)
{
    const float zero = 0.0f;
    const float last_n = state->last_n;
    if (force_n > zero) {
        return last_n > zero ? last_n : zero;
    }
    return last_n < zero ? last_n : zero;
}

/* Limit the model's force of a good sample. Only growth away from 0 is limited: a force may fall at
 * once. ticks: of this call, at most 1. Returns the force to render, N. */
static inline float soft_pad_output_limit(const soft_pad_output_config *config,
                                          soft_pad_output_state *state, float ticks, float force_n,
                                          int *notes)
{
    if (state->ramp < 1.0f) {
        force_n *= state->ramp;
        state->ramp += config->ramp_per_tick * ticks;
        *notes |= SP_NOTE_RAMPED;
    }
    force_n = soft_pad_output_clamp(config, force_n, notes);
    const float slew_n = config->slew_n * ticks;
    const float before_n = soft_pad_output_last_along(state, force_n);
    const float upper_n = before_n + slew_n;
    const float lower_n = before_n - slew_n;
    if (force_n > 0.0f) {
        if (force_n > upper_n) {
            *notes |= SP_NOTE_LIMITED;
            force_n = upper_n;
        }
    } else if (force_n < lower_n) {
        *notes |= SP_NOTE_LIMITED;
        force_n = lower_n;
    }
    state->last_n = force_n;
    return force_n;
}

/* ---------------------------------------------------------------------- constants of this scene */

static const soft_pad_silence_config soft_pad_scene_silence = {
    0.001f,  /* dt_s */
    1000.0f, /* rate_hz */
    0.0205f, /* watchdog_s */
};
static const soft_pad_guard_config soft_pad_scene_guard = {
    0.0027968f, /* max_step_m */
    -10.0f,     /* min_m */
    0.144908f,  /* max_m */
    0.0f,       /* air_m */
    5,          /* resync_ticks */
};
static const soft_pad_range_config soft_pad_scene_range = {
    0.0f,       /* min_m */
    0.0144908f, /* max_m */
};
static const soft_pad_output_config soft_pad_scene_output = {
    0.0f,       /* min_n */
    12.002745f, /* max_n */
    3.0006862f, /* slew_n */
    0.02f,      /* ramp_per_tick */
    1.5003431f, /* latch_fall_n */
};
static const float soft_pad_scene_onset_per_m = 6900.93f;

/* Curves: values and slopes at the nodes, a column a branch (sp_curve.h). */
static const float soft_pad_scene_spring[20] = {
    0.0f, 0.3289515f, 0.4162068f, 0.5034621f, 1.0135461f, 0.6912164f, 1.8122768f, 0.9062452f,
    2.8517995f, 1.1728001f, 4.18071f, 1.4850208f, 5.8518076f, 1.8571742f, 7.9441576f, 2.3275259f,
    10.581097f, 2.9463525f, 10.581097f, 2.9463525f
};
static const float soft_pad_scene_branches[20 * 12] = {
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 4.8114925e-09f, 0.0f,
    0.0010956825f, 0.0049506268f, 0.0009572887f, 0.0f, 0.0f, 0.0f, 0.9580456f, 0.051968426f,
    0.033191737f, 0.003189898f, 0.02059531f, 0.0063461633f, 0.0030521452f, 0.013387425f,
    0.007835361f, 0.0010873226f, 0.0f, 0.0f, 0.95666915f, 0.054877173f, 0.037263658f, 0.0042245756f,
    0.041190617f, 0.012692327f, 0.005008608f, 0.021824224f, 0.014713434f, 0.0021746452f, 0.0f, 0.0f,
    0.9552927f, 0.057785917f, 0.041335575f, 0.005259253f, 0.08215447f, 0.024655648f, 0.011671618f,
    0.041561566f, 0.029219355f, 0.0027201439f, 0.0f, 0.0f, 1.9099807f, 0.11369786f, 0.07970815f,
    0.011797012f, 0.08192769f, 0.023926642f, 0.012230337f, 0.03452406f, 0.028054556f, 0.0010909975f,
    0.0f, 0.0f, 0.9513302f, 0.059855454f, 0.043553412f, 0.009885618f, 0.18252112f, 0.050815817f,
    0.031925447f, 0.08323798f, 0.06524426f, 0.0032656426f, 0.0f, 0.0f, 2.8571808f, 0.16992246f,
    0.12041195f, 0.028875714f, 0.11880561f, 0.028393699f, 0.028277323f, 0.048828777f, 0.04399525f,
    0.0f, 0.0f, 0.0f, 0.9430701f, 0.052593745f, 0.037854183f, 0.024271784f, 0.3169425f, 0.07762715f,
    0.071740724f, 0.13944076f, 0.116920345f, 0.0032656426f, 0.0f, 0.0f, 3.793042f, 0.21545649f,
    0.15277083f, 0.06717869f, 0.15003717f, 0.025228968f, 0.05135323f, 0.06357676f, 0.059356917f,
    0.0f, 0.0f, 0.0f, 0.9286524f, 0.038474295f, 0.026863582f, 0.052334167f, 0.48052192f,
    0.09952954f, 0.13845365f, 0.21368329f, 0.1867985f, 0.0032656426f, 0.0f, 0.0f, 4.712427f,
    0.24720307f, 0.17490184f, 0.14013581f, 0.17712168f, 0.018575815f, 0.082072616f, 0.08490832f,
    0.08039939f, 0.0f, 0.0f, 0.0f, 0.9101176f, 0.025018869f, 0.01739843f, 0.09358008f, 0.67054856f,
    0.11481221f, 0.23868886f, 0.31340894f, 0.28203064f, 0.0053116116f, 0.0f, 0.0f, 5.612798f,
    0.26701307f, 0.18934962f, 0.26314995f, 0.20293155f, 0.011989515f, 0.118397795f, 0.114542976f,
    0.1100649f, 0.004091938f, 0.0f, 0.0f, 0.89062464f, 0.014601136f, 0.0114971325f, 0.15244815f,
    0.88954645f, 0.12368253f, 0.376028f, 0.44525757f, 0.40994075f, 0.013759043f, 0.0f, 0.0f,
    6.4936385f, 0.27703497f, 0.19766866f, 0.45604837f, 0.23506424f, 0.005751133f, 0.15628053f,
    0.14915429f, 0.14575534f, 0.012802924f, 0.0f, 0.0f, 0.87105614f, 0.0054426845f, 0.0051409486f,
    0.23334873f, 1.2389312f, 0.1265581f, 0.5553932f, 0.61767316f, 0.575621f, 0.027473312f, 0.0f,
    0.0f, 7.365221f, 0.2797563f, 0.20438221f, 0.7395865f, 0.46370512f, 0.0f, 0.20244983f,
    0.19567688f, 0.18560521f, 0.0146256145f, 0.0f, 0.0f, 0.8721091f, 0.0f, 0.008286146f,
    0.33372742f, 1.2389312f, 0.1265581f, 0.5553932f, 0.61767316f, 0.575621f, 0.027473312f, 0.0f,
    0.0f, 7.365221f, 0.2797563f, 0.20438221f, 0.7395865f, 0.46370512f, 0.0f, 0.20244983f,
    0.19567688f, 0.18560521f, 0.0146256145f, 0.0f, 0.0f, 0.8721091f, 0.0f, 0.008286146f,
    0.33372742f
};
static const float soft_pad_scene_branch_loss[8] = {
    0.39346933f, 0.2176933f, 0.014169568f, 0.0069827656f, 0.0016880065f, 0.00019998f, 1.0f, 1.0f
};
static const float soft_pad_scene_depth_branch_loss[10 * 4] = {
    0.86466473f, 0.34180617f, 0.08375269f, 0.00079968007f, 0.75688326f, 0.25602773f, 0.059976026f,
    0.00056552544f, 0.63212055f, 0.18870854f, 0.04279192f, 0.00039992f, 0.5069313f, 0.13746174f,
    0.030451665f, 0.0002828027f, 0.39346933f, 0.09928281f, 0.021629887f, 0.00019998f, 0.2978115f,
    0.071270615f, 0.015343544f, 0.00014141135f, 0.22119921f, 0.050938785f, 0.010874066f,
    9.9995e-05f, 0.16203311f, 0.036293935f, 0.007701428f, 7.070818e-05f, 0.1175031f, 0.025802271f,
    0.0054518944f, 4.999875e-05f, 0.1175031f, 0.025802271f, 0.0054518944f, 4.999875e-05f
};
/* At most so stiff is each piece of the depth, N a piece (sp_surface.h). */
static const float soft_pad_scene_max_slope_n[9] = {
    1.6607395f, 1.9375955f, 2.2323358f, 2.568678f, 2.9742138f, 3.4883642f, 4.1473236f, 5.2225385f,
    5.2225385f
};
static const float soft_pad_scene_stops[3 * 20] = {
    0.0f, 0.15894209f, 0.15834557f, 0.15774904f, 0.3162937f, 0.15814722f, 0.47856778f, 0.16640097f,
    0.6499993f, 0.17646207f, 0.8308018f, 0.18514296f, 1.0203971f, 0.19404763f, 1.2193344f,
    0.20382681f, 1.4395807f, 0.236666f, 1.4395807f, 0.236666f, 0.0f, 0.00746892f, 0.0044102333f,
    0.0013515467f, 0.0050860066f, 0.0f, 0.0050860066f, 0.0f, 0.0050860066f, 0.0f, 0.0050860066f,
    0.0f, 0.0050860066f, 0.0f, 0.008763529f, 0.007355046f, 0.0164275f, 0.007972893f, 0.0164275f,
    0.007972893f, 0.0f, 0.00019970951f, 0.0002644874f, 0.0003292653f, 0.0007005534f, 0.0005428667f,
    0.0014195048f, 0.0008950359f, 0.013550747f, 0.02336745f, 0.056328285f, 0.06218763f, 0.14368843f,
    0.11253266f, 0.28524727f, 0.17058499f, 0.48186234f, 0.22264516f, 0.48186234f, 0.22264516f
};
static const float soft_pad_scene_stop_radius[3] = {
    0.02f, 0.2f, 0.5f
};
static const soft_pad_hammerstein_config soft_pad_scene_passive = {
    0.0f,     /* origin_m */
    69.0093f, /* u_per_m */
    0.0f,     /* bias_n */
    9,        /* n_intervals */
    12,       /* n_branches */
    3,        /* n_stops */
};
static const soft_pad_hammerstein_tables soft_pad_scene_passive_tables = {
    soft_pad_scene_spring,      /* spring */
    soft_pad_scene_branches,    /* branches */
    soft_pad_scene_stops,       /* stops */
    soft_pad_scene_stop_radius, /* radius */
};

/* ---------------------------------------------------- the tick, and the functions of the header */

/* Restart the history at position_m: the object is taken to have rested there for a long time. */
static void soft_pad_restart_at(soft_pad_state *state, float position_m)
{
    const float penetration_m = position_m > 0.0f ? position_m : 0.0f;
    const float penetration_u = soft_pad_hammerstein_u(&soft_pad_scene_passive, penetration_m);
    soft_pad_hammerstein_rest(&soft_pad_scene_passive, &soft_pad_scene_passive_tables,
                              penetration_u, state->penetration_before, state->penetration_held,
                              state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = 0.0f;
    soft_pad_output_begin_ramp(&state->output);
}

/* Advance the model by one tick with the tool at position_m. Returns the force before its limits,
 * N. */
SOFT_PAD_NOINLINE float soft_pad_advance_model(soft_pad_state *state, float position_m, int *notes)
{
    const float penetration_m = position_m > 0.0f ? position_m : 0.0f;
    (void)soft_pad_range_clip(&soft_pad_scene_range, penetration_m, notes);
    const float penetration_tool_u = soft_pad_hammerstein_u(&soft_pad_scene_passive, penetration_m);
    const float penetration_u = soft_pad_surface_model_u(soft_pad_scene_max_slope_n,
                                                         soft_pad_scene_passive.n_intervals,
                                                         &state->penetration_surface,
                                                         penetration_tool_u);
    const soft_pad_curve_position penetration_on_curve =
        soft_pad_curve_locate(penetration_u, soft_pad_scene_passive.n_intervals);
    float penetration_branch[12];
    soft_pad_curve(soft_pad_scene_branches, 12, penetration_on_curve, penetration_branch);
    soft_pad_poles_separate(soft_pad_scene_branch_loss, 8,
        penetration_branch, state->penetration_before, state->penetration_held);
    soft_pad_poles_by_depth(soft_pad_scene_depth_branch_loss, 4, penetration_on_curve,
        penetration_branch + 8, state->penetration_before + 8, state->penetration_held + 8);
    const float penetration_held_n = soft_pad_hammerstein_force(&soft_pad_scene_passive,
                                                                &soft_pad_scene_passive_tables,
                                                                penetration_u, penetration_on_curve,
                                                                state->penetration_held,
                                                                state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = penetration_held_n;
    const float penetration_passive_n = penetration_held_n > 0.0f &&
        !(penetration_u > penetration_tool_u) ? penetration_held_n : 0.0f;
    float force_n = 0.0f;
    if (position_m > 0.0f) {
        force_n = penetration_passive_n;
        force_n = soft_pad_contact_onset(soft_pad_scene_onset_per_m, position_m, force_n);
    } else {
        soft_pad_output_end_ramp(&state->output);
    }
    return force_n;
}

/* Hold the last force for dt_s without a good sample, scaled by `fraction` (0 .. 1). Once the
 * watchdog has latched, let it fall to zero instead. */
static int soft_pad_hold_force(soft_pad_state *state, float dt_s, float fraction, float *force_n)
{
    int notes = SP_NOTE_HELD;
    const float latched_ticks = soft_pad_silence_no_sample(&soft_pad_scene_silence, &state->silence,
                                                           dt_s);
    float held_n = fraction * soft_pad_output_clamp(&soft_pad_scene_output, state->output.last_n,
                                                    &notes);
    state->output.last_n = held_n;
    if (state->silence.latched) {
        notes = 0;
        held_n = soft_pad_output_fall_latched(&soft_pad_scene_output, &state->output, latched_ticks,
                                              &notes);
    }
    *force_n = held_n;
    return notes;
}

/* Advance the model through the missed ticks, on a path from the last good position to position_m.
 * step_m: travel per tick. */
SOFT_PAD_COLD void soft_pad_catch_up(soft_pad_state *state, float position_m, float step_m,
                      uint32_t missed_ticks)
{
    for (; missed_ticks > 0; missed_ticks--) {
        const float remaining_m = (float)missed_ticks * step_m;
        const float missed_m = soft_pad_guard_clamp(&soft_pad_scene_guard, position_m -
                                                    remaining_m);
        int ignored_notes = 0;
        (void)soft_pad_advance_model(state, missed_m, &ignored_notes);
    }
}

/* One tick with a new sample: check the sample, make up for missed ticks, evaluate the model,
 * limit the force. Returns notes or an error. */
int soft_pad_step(soft_pad_state *state, float position_m, float velocity_mps, float *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SOFT_PAD_STATE_MAGIC) {
        return SP_ERROR_STATE;
    }
    uint32_t missed_ticks = 0;
    float ticks = 1.0f; /* since the last good sample, this one included */
    if (state->silence.silent_s > 0.0f) {
        missed_ticks = soft_pad_silence_missed_ticks(&soft_pad_scene_silence, &state->silence,
                                                     soft_pad_scene_silence.dt_s);
        ticks = (float)(missed_ticks + 1);
    }
    (void)velocity_mps;
    int notes = 0;
    const float last_good_m = state->guard.last_good_m;
    const float good_m = soft_pad_guard_accept(&soft_pad_scene_guard, &state->guard, ticks,
                                               position_m, &notes);
    if (notes & SP_NOTE_HELD) {
        /* A lone outlier is a read error, such as a 0 at depth: it does not lower the force. */
        const float fraction = state->silence.silent_s > 0.0f
                                     ? soft_pad_guard_held_fraction(&soft_pad_scene_guard,
                                                                    &state->guard, position_m)
                                     : 1.0f;
        return soft_pad_hold_force(state, soft_pad_scene_silence.dt_s, fraction, force_n);
    }
    soft_pad_silence_good_sample(&state->silence, soft_pad_scene_silence.dt_s);
    float travel_m = good_m - last_good_m;
    if (notes & SP_NOTE_RESYNC) {
        soft_pad_restart_at(state, good_m);
        missed_ticks = 0;
        ticks = 1.0f;
        travel_m = 0.0f;
    }
    if (missed_ticks > 0) {
        soft_pad_catch_up(state, good_m, travel_m / ticks, missed_ticks);
    }
    const float model_force_n = soft_pad_advance_model(state, good_m, &notes);
    if (state->silence.latched) {
        (void)soft_pad_output_fall_latched(&soft_pad_scene_output, &state->output, 1.0f, &notes);
    } else {
        (void)soft_pad_output_limit(&soft_pad_scene_output, &state->output, 1.0f, model_force_n,
                                    &notes);
    }
    *force_n = state->output.last_n;
    return notes;
}

/* Run soft_pad_step over n recorded samples. Returns the notes of all of them. */
int soft_pad_run(soft_pad_state *state, uint32_t n, const float *position_m,
                 const float *velocity_mps, float *force_n)
{
    if (state == NULL || position_m == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    (void)velocity_mps;
    int notes = 0;
    for (uint32_t i = 0; i < n; i++) {
        notes |= soft_pad_step(state, position_m[i], 0.0f, &force_n[i]);
    }
    return notes;
}

/* A tick without a new sample: hold the last force, or let it fall once the silence is too
 * long. */
int soft_pad_idle(soft_pad_state *state, float dt_s, float *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SOFT_PAD_STATE_MAGIC) {
        return SP_ERROR_STATE;
    }
    if (!soft_pad_is_valid_dt(dt_s)) {
        return SP_ERROR_TIME_STEP;
    }
    return soft_pad_hold_force(state, dt_s, 1.0f, force_n);
}

/* The ticks of a game's picture, on a straight line to position_m. */
int soft_pad_advance(soft_pad_state *state, float seconds, float position_m, float *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SOFT_PAD_STATE_MAGIC) {
        return SP_ERROR_STATE;
    }
    if (!(seconds >= 0.0f)) { /* false for NaN */
        return SP_ERROR_TIME_STEP;
    }
    /* A damaged state may hold any remainder. */
    const int whole = soft_pad_abs(state->remainder_s) <= soft_pad_scene_silence.dt_s;
    const float since_s =
        (whole ? state->remainder_s : 0.0f) + (seconds < 1.0f ? seconds : 1.0f);
    /* A thousandth of a tick is added against rounding. */
    const float ticks = since_s / soft_pad_scene_silence.dt_s + (float)0.001;
    const uint32_t n_ticks = ticks > 0.0f ? (uint32_t)ticks : 0u;
    /* A cursor jumps, leaves the screen and goes through walls. The tool behind it stays between
     * a step above the surface and the trained depth, and is no faster than a hand: the guard,
     * which is for a sensor, rejects none of its positions, and no dent is left that takes ten
     * seconds to recover, as of ten trained depths. */
    const float lowest_m = -soft_pad_scene_guard.max_step_m;
    const int known = position_m == position_m;
    float to_m = known ? position_m : state->guard.last_good_m;
    to_m = to_m > lowest_m ? to_m : lowest_m;
    to_m = to_m < soft_pad_scene_range.max_m ? to_m : soft_pad_scene_range.max_m;
    int notes = known ? 0 : SP_NOTE_HELD;
    *force_n = state->output.last_n;
    if (!state->guard.started) { /* a tool that is seen first at depth came from above */
        notes |= soft_pad_step(state, lowest_m, 0.0f, force_n);
    }
    const float from_m = state->guard.last_good_m;
    /* A hundredth less than the guard lets pass, for rounding. */
    const float longest_m = (float)0.99 * soft_pad_scene_guard.max_step_m;
    const float tick_share = since_s > 0.0f ? soft_pad_scene_silence.dt_s / since_s : 0.0f;
    float step_m = (to_m - from_m) * tick_share;
    step_m = step_m < longest_m ? step_m : longest_m;
    step_m = step_m > -longest_m ? step_m : -longest_m;
    for (uint32_t tick = 1; tick <= n_ticks; tick++) {
        notes |= soft_pad_step(state, from_m + (float)tick * step_m, 0.0f, force_n);
    }
    state->remainder_s = since_s - (float)n_ticks * soft_pad_scene_silence.dt_s;
    return notes;
}

/* Begin with an object at rest and untouched. */
void soft_pad_init(soft_pad_state *state)
{
    if (state != NULL) {
        (void)memset(state, 0, sizeof *state);
        state->begun = SOFT_PAD_STATE_MAGIC;
    }
}

/* Begin anew after a latch or a pause; the site stays. */
void soft_pad_reset(soft_pad_state *state)
{
    soft_pad_init(state);
}

uint32_t soft_pad_abi_version(void)
{
    return 1;
}

uint32_t soft_pad_state_size(void)
{
    return (uint32_t)sizeof(soft_pad_state);
}

const char *soft_pad_manifest(void)
{
    return "{\"springpot\": \"0.1.0\", \"hash\": \"6152aa5b2c6b1ceb25570421c93982d95cb888eee53319afc2d2078d0c71550a\", \"scene\": \"pad\", \"model\": \"hammerstein\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [0.0, 0.014490800000000002], \"speed_mps\": 0.34960000000000024, \"force_n\": [-0.025496118180619507, 10.002287521128789]}}";
}

/* ------------------------------------------------------------------------------------ self-test */

#ifndef SP_NO_SELFTEST /* to leave it out of an image */

static const uint32_t soft_pad_scene_golden_position[600] = {
    0xba3def0eu, 0xba3c866fu, 0xba385cc8u, 0xba318a67u, 0xba28279du, 0xba1c4cb9u, 0xba0e120cu,
    0xb9fb1fc9u, 0xb9d5bd25u, 0xb9ac2ccdu, 0xb97d3ebeu, 0xb91a8af6u, 0xb8427e02u, 0x388044c5u,
    0x39375975u, 0x399a523cu, 0x39dbd115u, 0x3a0ffc54u, 0x3a334c2au, 0x3a57bfbdu, 0x3a7d3ebeu,
    0x3a91d86eu, 0x3aa57ee4u, 0x3ab98699u, 0x3acde365u, 0x3ae28920u, 0x3af76ba2u, 0x3b063f62u,
    0x3b10db2fu, 0x3b1b8324u, 0x3b26312du, 0x3b30df35u, 0x3b3b872au, 0x3b4622f7u, 0x3b50ac88u,
    0x3b5b1dc9u, 0x3b6570a7u, 0x3b6f9f0du, 0x3b79a2e7u, 0x3b81bb11u, 0x3b868955u, 0x3b8b3935u,
    0x3b8fc7a7u, 0x3b9431a2u, 0x3b98741bu, 0x3b9c8c09u, 0x3ba07661u, 0x3ba4301au, 0x3ba7b629u,
    0x3bab0584u, 0x3bae1b23u, 0x3bb0f3f9u, 0x3bb38cffu, 0x3bb5e329u, 0x3bb7f36eu, 0x3bb9bac4u,
    0x3bbb3620u, 0x3bbc6279u, 0x3bbd3cc6u, 0x3bbdc1fbu, 0x3bbdef0eu, 0x3bbdd603u, 0x3bbd8c02u,
    0x3bbd12bcu, 0x3bbc6bdfu, 0x3bbb991eu, 0x3bba9c27u, 0x3f0172edu, 0x3bb82a5bu, 0x3bb6b8e6u,
    0x3bb523fdu, 0x3bb36d50u, 0x3bb1968fu, 0x3bafa16au, 0x3bad8f92u, 0x3bab62b6u, 0x3ba91c87u,
    0x3ba6beb6u, 0x3ba44af2u, 0x3ba1c2ebu, 0x3b9f2852u, 0x3b9c7cd7u, 0x3b99c22au, 0x3b96f9fcu,
    0x3b9425fcu, 0x3b9147dbu, 0x3b8e6149u, 0x3b8b73f6u, 0x3b888192u, 0x3b858bceu, 0x3b82945au,
    0x3b7f39cbu, 0x3b794e43u, 0x3b73697cu, 0x3b6d8ed6u, 0x3b67c1b2u, 0x3b620570u, 0x3b5c5d70u,
    0x3b56cd13u, 0x3b5157bau, 0x3b4c00c4u, 0x3b46cb92u, 0x3b41bb84u, 0x3b3cd3fcu, 0x3b381859u,
    0x3b338bfcu, 0x3b2f3244u, 0x3b2b0e94u, 0x3b27244au, 0x3b2376c8u, 0x3b20096du, 0x3b1cdf9bu,
    0x3b19fcb1u, 0x3b176411u, 0x3b151919u, 0x3b131f2cu, 0x3b1179a9u, 0x3b102bf0u, 0x3b0f3963u,
    0x3b0ea561u, 0x3b0e734bu, 0x3b0f098du, 0x3b10c593u, 0x3b139d3bu, 0x3b178665u, 0x3b1c76eeu,
    0x3b2264b7u, 0x3b29459cu, 0x3b310f7eu, 0x3b39b83bu, 0x3b4335b2u, 0x7fc00000u, 0x7fc00000u,
    0x7fc00000u, 0x7fc00000u, 0x3b7dbd5du, 0x3b85b13bu, 0x3b8ccaafu, 0x3b9425fcu, 0x3b9bbe10u,
    0x3ba38ddbu, 0x3bab904cu, 0x3bb3c052u, 0x3bbc18ddu, 0x3bc494ddu, 0x3bcd2f40u, 0x3bd5e2f7u,
    0x3bdeaaf0u, 0x3be7821au, 0x3bf06366u, 0x3bf949c3u, 0x3c011810u, 0x3c0588b6u, 0x3c09f44bu,
    0x3c0e5848u, 0x3c12b223u, 0x3c16ff54u, 0x3c1b3d54u, 0x3c1f699au, 0x3c23819du, 0x3c2782d6u,
    0x3c2b6abbu, 0x3c2f36c5u, 0x3c32e46bu, 0x3c367126u, 0x3c39da6cu, 0x3c3d1db5u, 0x3c403879u,
    0x3c432831u, 0x3c45ea52u, 0x3c487c56u, 0x3c4adbb4u, 0x3c4d05e3u, 0x3c4ef85cu, 0x3c50b095u,
    0x3c522c07u, 0x3c53682au, 0x3c546274u, 0x3c55185eu, 0x3c558760u, 0x3c55acf0u, 0x3c55b1f2u,
    0x3c55c0bfu, 0x3c55d901u, 0x3c55fa60u, 0x3c562487u, 0x3c56571eu, 0x3c5691d1u, 0x3c56d447u,
    0x3c571e2bu, 0x3c576f27u, 0x3c57c6e3u, 0x3c58250au, 0x3c588944u, 0x3c58f33cu, 0x3c59629cu,
    0x3c59d70bu, 0x3c5a5035u, 0x3c5acdc3u, 0x3c5b4f5eu, 0x3c5bd4b0u, 0x3c5c5d62u, 0x3c5ce91eu,
    0x3c5d778eu, 0x3c5e085au, 0x3c5e9b2eu, 0x3c5f2fb1u, 0x3c5fc58fu, 0x3c605c6fu, 0x3c60f3fdu,
    0x3c618be1u, 0x3c6223c5u, 0x3c62bb53u, 0x3c635233u, 0x3c63e811u, 0x3c647c94u, 0x3c650f68u,
    0x3c65a035u, 0x3c662ea4u, 0x3c66ba61u, 0x3c674313u, 0x3c67c865u, 0x3c6849ffu, 0x3c68c78du,
    0x3c6940b7u, 0x3c69b527u, 0x3c6a2486u, 0x3c6a8e7eu, 0x3c6af2b8u, 0x3c6b50dfu, 0x3c6ba89bu,
    0x3c6bf997u, 0x3c6c437bu, 0x3c6c85f1u, 0x3c6cc0a4u, 0x3c6cf33cu, 0x3c6d1d62u, 0x3c6d3ec1u,
    0x3c6d5703u, 0x3c6d65d0u, 0x3c6d6ad2u, 0x3c6d5bcbu, 0x3c6d2f64u, 0x3c6ce6a0u, 0x3c6c8283u,
    0x3c6c040eu, 0x3c6b6c47u, 0x3c6abc30u, 0x3c69f4cdu, 0x3c691720u, 0x3c68242eu, 0x3c671cf9u,
    0x3c660285u, 0x3c64d5d6u, 0x3c6397eeu, 0x3c6249d0u, 0x3c60ec81u, 0x3c5f8103u, 0x3c5e085au,
    0x3c5c838au, 0x3c5af394u, 0x3c59597eu, 0x3c57b649u, 0x3c560afau, 0x3c545894u, 0x3c52a019u,
    0x3c50e28fu, 0x3c4f20f6u, 0x3c4d5c54u, 0x3c4b95abu, 0x3c49cdffu, 0x3c480653u, 0x3c463faau,
    0x3c447b08u, 0x3c42b970u, 0x3c40fbe5u, 0x3c3f436bu, 0x3c3d9105u, 0x3c3be5b6u, 0x3c3a4281u,
    0x3c38a86au, 0x3c371875u, 0x3c3593a4u, 0x3c341afbu, 0x3c32af7eu, 0x3c31522eu, 0x3c300411u,
    0x3c2ec629u, 0x3c2d9979u, 0x3c2c7f05u, 0x3c2b77d1u, 0x3c2a84deu, 0x3c29a732u, 0x3c28dfceu,
    0x3c282fb7u, 0x3c2797f0u, 0x3c27197cu, 0x3c26b55eu, 0x3c266c9au, 0x3c264033u, 0x3c26312du,
    0x3c264535u, 0x3c268069u, 0x3c26e16fu, 0x3c2766ecu, 0x3c280f87u, 0x3c28d9e6u, 0x3c29c4afu,
    0x3c2ace89u, 0x3c2bf61au, 0x3c2d3a07u, 0x3c2e98f8u, 0x3c301193u, 0x3c31a27du, 0x3c334a5du,
    0x3c3507dau, 0x3c36d999u, 0x3c38be40u, 0x3c3ab477u, 0x3c3cbae3u, 0x3c3ed02au, 0x3c40f2f3u,
    0x3c4321e3u, 0x3c455ba2u, 0x3c479ed5u, 0x3c49ea23u, 0x3c4c3c31u, 0x3c4e93a7u, 0x3c50ef2au,
    0x3c534d60u, 0x3c55acf0u, 0x3c580c80u, 0x3c5a6ab7u, 0x3c5cc63au, 0x3c5f1dafu, 0x3c616fbeu,
    0x3c63bb0bu, 0x3c65fe3fu, 0x3c6837fdu, 0x3c6a66eeu, 0x3c6c89b7u, 0x3c6e9efeu, 0x3c70a56au,
    0x3c729ba0u, 0x3c748048u, 0x3c765207u, 0x3c780f83u, 0x3c79b763u, 0x3c7b484eu, 0x3c7cc0e8u,
    0x3c7e1fd9u, 0x3c7f63c7u, 0x3c8045acu, 0x3c80ca99u, 0x3c813ffdu, 0x3c81a52du, 0x3c81f97au,
    0x3c823c39u, 0x3c826cbcu, 0x3c828a55u, 0x3c82945au, 0x3c828051u, 0x3c82451du, 0x3c81e418u,
    0x3c815e9bu, 0x3c80b600u, 0x3c7fd742u, 0x3c7e01afu, 0x3c7bedfbu, 0x3c799edau, 0x3c7716ffu,
    0x3c74591du, 0x3c7167e8u, 0x3c6e4613u, 0x3c6af653u, 0x3c677b5au, 0x3c63d7dcu, 0x3c600e8cu,
    0x3c5c221fu, 0x3c581548u, 0x3c53eabau, 0x3c4fa528u, 0x3c4b4747u, 0x3c46d3c9u, 0x3c424d63u,
    0x3c3db6c8u, 0x3c3912abu, 0x3c3463bfu, 0x3c2facbau, 0x3c2af04du, 0x3c26312du, 0x3c21720cu,
    0x3c1cb5a0u, 0x3c17fe9au, 0x3c134fafu, 0x3c0eab92u, 0x3c0a14f6u, 0x3c058e90u, 0x3c011b13u,
    0x3bf97a62u, 0x3bf0ef3fu, 0x3be89a23u, 0x3be08074u, 0x3bd8a79au, 0x3bd114fbu, 0x3bc9cdffu,
    0x3bc2d80du, 0x3bbc388cu, 0x3bb5f4e3u, 0x3bb01279u, 0x3baa96b5u, 0x3ba586feu, 0x3ba0e8bcu,
    0x3b9cc154u, 0x3b99162fu, 0x3b95ecb3u, 0x3b934a48u, 0x3b913454u, 0x3b8fb03eu, 0x3b8ec36eu,
    0x3c50b18au, 0x3c50a182u, 0x3c507226u, 0x3c502488u, 0x3c4fb9bdu, 0x3c4f32dbu, 0x3c4e90f6u,
    0x3c4dd521u, 0x3c4d0073u, 0x3c4c13ffu, 0x3c4b10dau, 0x3c49f81au, 0x3c48cad1u, 0x3c478a16u,
    0x3c4636fcu, 0x3c44d298u, 0x3c435e00u, 0x3c41da46u, 0x3c404881u, 0x3c3ea9c4u, 0x3c3cff25u,
    0x3c3b49b8u, 0x3c398a91u, 0x3c37c2c5u, 0x3c35f369u, 0x3c341d91u, 0x3c324252u, 0x3c3062c1u,
    0x3c2e7ff2u, 0x3c2c9afau, 0x3c2ab4edu, 0x3c28cee0u, 0x3c26e9e8u, 0x3c250719u, 0x3c232787u,
    0x3c214c48u, 0x3c1f7671u, 0x3c1da715u, 0x3c1bdf49u, 0x3c1a2022u, 0x3c186ab5u, 0x3c16c015u,
    0x3c152159u, 0x3c138f93u, 0x3c120bdau, 0x3c109741u, 0x3c0f32deu, 0x3c0ddfc4u, 0x3c0c9f09u,
    0x3c0b71c0u, 0x3c0a58ffu, 0x3c0955dbu, 0x3c086967u, 0x3c0794b9u, 0x3c06d8e4u, 0x3c0636ffu,
    0x3c05b01du, 0x3c054552u, 0x3c04f7b4u, 0x3c04c858u, 0x3c04b850u, 0x3c04d75eu, 0x3c053322u,
    0x3c05c984u, 0x3c06986cu, 0x3c079dc2u, 0x3c08d76fu, 0x3c0a435au, 0x3c0bdf6cu, 0x3c0da98cu,
    0x3c0f9fa3u, 0x3c11bf99u, 0x3c140755u, 0x3c1674c0u, 0x3c1905c2u, 0x3c1bb843u, 0x3c1e8a2bu,
    0x3c217962u, 0x3c2483d0u, 0x3c27a75eu, 0x3c2ae1f2u, 0x3c2e3176u, 0x3c3193d2u, 0x3c3506edu,
    0x3c3888afu, 0x3c3c1701u, 0x3c3fafcbu, 0x3c4350f4u, 0x3c46f866u, 0x3c4aa406u, 0x3c4e51c0u,
    0x3c51ff78u, 0x3c55ab1au, 0x3c59528bu, 0x3c5cf3b4u, 0x3c608c7eu, 0x3c641ad0u, 0x3c679c92u,
    0x3c6b0faeu, 0x3c6e7209u, 0x3c71c18du, 0x3c74fc22u, 0x3c781fafu, 0x3c7b2a1du, 0x3c7e1954u,
    0x3c80759eu, 0x3c81cedeu, 0x3c831760u, 0x3c844e15u, 0x3c8571f3u, 0x3c8681eeu, 0x3c877cfau,
    0x3c88620au, 0x3c893012u, 0x3c89e608u, 0x3c8a82deu, 0x3c8b058au, 0x3c8b6cfeu, 0x3c8bb82eu,
    0x3c8be610u, 0x3c8bf598u, 0x3c8be691u, 0x3c8bba2au, 0x3c8b7166u, 0x3c8b0d48u, 0x3c8a8ed4u,
    0x3c89f70cu, 0x3c8946f6u, 0x3c887f92u, 0x3c87a1e6u, 0x3c86aef4u, 0x3c85a7beu, 0x3c848d4bu,
    0x3c83609bu, 0x3c8222b3u, 0x3c80d496u, 0x3c7eee8cu, 0x3c7c1792u, 0x3c792640u, 0x3c761c9eu,
    0x3c72fcb3u, 0x3c6fc886u, 0x3c6c821du, 0x3c692b7fu, 0x3c65c6b2u, 0x3c6255beu, 0x3c5edaa8u,
    0x3c5b5778u, 0x3c57ce33u, 0x3c5440e2u, 0x3c50b18au, 0x3c4d2231u, 0x3c4994e0u, 0x3c460b9bu,
    0x3c42886bu, 0x3c3f0d55u, 0x3c3b9c61u, 0x3c383794u, 0x3c34e0f6u, 0x3c319a8du, 0x3c2e6660u,
    0x3c2b4675u, 0x3c283cd3u, 0x3c254b82u, 0x3c227486u, 0x3c1fb9e8u, 0x3c1d1dadu, 0x3c1aa1ddu,
    0x3c18487du, 0x3c161395u, 0x3c14052cu, 0x3c121f47u, 0x3c1063eeu, 0x3c0ed528u, 0x3c0d74fau,
    0x3c0c456bu, 0x3c0b4883u, 0x3c0a8047u, 0x3c09eebfu, 0x3c0995f1u
};
static const uint32_t soft_pad_scene_golden_force[600] = {
    0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x3c61335du,
    0x3d9f6552u, 0x3de27775u, 0x3e07d0a8u, 0x3e1fb0c8u, 0x3e3944dcu, 0x3e54b527u, 0x3e721a27u,
    0x3e88c272u, 0x3e998070u, 0x3eab4a69u, 0x3ebe215cu, 0x3ed2040bu, 0x3ee6f670u, 0x3efcf437u,
    0x3f09f6bau, 0x3f15eaecu, 0x3f225080u, 0x3f2f202fu, 0x3f3c5180u, 0x3f49b9e3u, 0x3f5768c3u,
    0x3f655c0fu, 0x3f73869au, 0x3f80ecc4u, 0x3f8824acu, 0x3f8f650cu, 0x3f96a4c7u, 0x3f9ddabau,
    0x3fa4fd70u, 0x3fac02e8u, 0x3fb2e093u, 0x3fb98b71u, 0x3fbff7b3u, 0x3fc619ecu, 0x3fcbe67eu,
    0x3fd151d0u, 0x3fd6503bu, 0x3fdad628u, 0x3fded76fu, 0x3fe24a8bu, 0x3fe5257au, 0x3fe75ddfu,
    0x3fe8e99eu, 0x3fe9bf3fu, 0x3fe9d5fcu, 0x3fe92606u, 0x3fe7a8a4u, 0x3fe5a5b2u, 0x3fe36070u,
    0x3fe0c8e8u, 0x3fddd958u, 0x3fda918eu, 0x3fd6f435u, 0x3fd6f435u, 0x3fcedc6fu, 0x3fca5357u,
    0x3fc58ddeu, 0x3fc0902eu, 0x3fbb5f82u, 0x3fb600dfu, 0x3fb07914u, 0x3faacd69u, 0x3fa5ab7eu,
    0x3fa0a15au, 0x3f9b8a9au, 0x3f966b9eu, 0x3f9148bau, 0x3f8c260cu, 0x3f87078cu, 0x3f81f101u,
    0x3f79cc09u, 0x3f6fd416u, 0x3f660097u, 0x3f5c57a4u, 0x3f52def9u, 0x3f499bf3u, 0x3f40936du,
    0x3f37c9f4u, 0x3f2f43bau, 0x3f270486u, 0x3f1f0fb9u, 0x3f1767c5u, 0x3f100d3eu, 0x3f090199u,
    0x3f024698u, 0x3ef7bce6u, 0x3eeb94e3u, 0x3ee01758u, 0x3ed54610u, 0x3ecb22b7u, 0x3ec1ae86u,
    0x3eb8eaa6u, 0x3eb0d7fcu, 0x3ea9776au, 0x3ea2c9a5u, 0x3e9ccf6cu, 0x3e97899eu, 0x3e92f921u,
    0x3e8f1f22u, 0x3e8bfd1bu, 0x3e8994cdu, 0x3e87e896u, 0x3e86fb35u, 0x3e86d02fu, 0x3e876bcau,
    0x3e88d311u, 0x3e8b0c1du, 0x3e908597u, 0x3e9ab5d2u, 0x3ea873ceu, 0x3eb965d6u, 0x3ecd718du,
    0x3ee493c2u, 0x3efed3dau, 0x3f0e1fdbu, 0x3f1ca816u, 0x3f2b6a8bu, 0x3f2b6a8bu, 0x3f2b6a8bu,
    0x3f2b6a8bu, 0x3f2b6a8bu, 0x3f84a75cu, 0x3f91895cu, 0x3f9ee8eau, 0x3fad0f03u, 0x3fbc1accu,
    0x3fcc1b4cu, 0x3fdd1879u, 0x3fef1412u, 0x40010b50u, 0x400b177cu, 0x4015b192u, 0x4020da1cu,
    0x402c8f78u, 0x4038cec0u, 0x40459001u, 0x4052d70au, 0x4060a859u, 0x406efef3u, 0x407dd31eu,
    0x40868d7cu, 0x408e656au, 0x4096681au, 0x409e98efu, 0x40a6f214u, 0x40af6ac7u, 0x40b7f919u,
    0x40c0920au, 0x40c929c3u, 0x40d1b228u, 0x40da2346u, 0x40e27447u, 0x40ea95d8u, 0x40f27808u,
    0x40fa0a64u, 0x41009e08u, 0x4103fe02u, 0x41071c8eu, 0x4109f127u, 0x410c7369u, 0x410e9b20u,
    0x411062ecu, 0x4111c1a2u, 0x4112aeb9u, 0x411322e2u, 0x411317f2u, 0x411288f0u, 0x4111d1e3u,
    0x41114d24u, 0x4110f289u, 0x4110bbf3u, 0x4110a4b6u, 0x4110a912u, 0x4110c60au, 0x4110f916u,
    0x4111401fu, 0x41119958u, 0x41120326u, 0x41127c2cu, 0x4113032du, 0x41139714u, 0x411436d9u,
    0x4114e18du, 0x4115965au, 0x41165470u, 0x41171b0au, 0x4117e96eu, 0x4118bee6u, 0x41199ac6u,
    0x411a7c65u, 0x411b6314u, 0x411c4e34u, 0x411d3d18u, 0x411e2f21u, 0x411f23a4u, 0x41201a01u,
    0x4121118au, 0x41220992u, 0x41230178u, 0x4123f87fu, 0x4124ee08u, 0x4125e158u, 0x4126d1c0u,
    0x4127be88u, 0x4128a6f7u, 0x41298a5cu, 0x412a67f5u, 0x412b3f06u, 0x412c0ecdu, 0x412cd692u,
    0x412d958eu, 0x412e4affu, 0x412ef620u, 0x412f9632u, 0x41302a6cu, 0x4130b20eu, 0x41312c51u,
    0x41319878u, 0x4131f5bau, 0x41324356u, 0x4132809cu, 0x4132acc2u, 0x4132c712u, 0x4132ced8u,
    0x4132c36bu, 0x4132a40fu, 0x41327025u, 0x41320ab4u, 0x41315ae1u, 0x4130667du, 0x412f32a8u,
    0x412dc406u, 0x412c1f02u, 0x412a47c5u, 0x4128426au, 0x412612e2u, 0x4123bd0fu, 0x412144beu,
    0x411eada8u, 0x411bfb6cu, 0x41193bfcu, 0x41168766u, 0x4113c38eu, 0x4110f37eu, 0x410e1a22u,
    0x410b3a4bu, 0x410856a0u, 0x410571b2u, 0x41028de7u, 0x40ff5b13u, 0x40f9a577u, 0x40f3fef9u,
    0x40ee6b65u, 0x40e8ee2bu, 0x40e38336u, 0x40de2c47u, 0x40d8ed82u, 0x40d3caa2u, 0x40cec677u,
    0x40c9e367u, 0x40c52385u, 0x40c088bcu, 0x40bc14bdu, 0x40b7c914u, 0x40b3a72bu, 0x40afb049u,
    0x40abe5a0u, 0x40a84849u, 0x40a4d93au, 0x40a19965u, 0x409e89a4u, 0x409bab21u, 0x4098fd4eu,
    0x40968080u, 0x4094356fu, 0x40921cdeu, 0x409037acu, 0x408e86bdu, 0x408d0b17u, 0x408bc5c1u,
    0x408ab7f2u, 0x4089e2ecu, 0x40894815u, 0x4088e8eeu, 0x4088c727u, 0x4088e496u, 0x40894342u,
    0x4089f882u, 0x408b135bu, 0x408c8cf3u, 0x408e5ff9u, 0x40908856u, 0x409302d0u, 0x4095ccc6u,
    0x4098e422u, 0x409c4712u, 0x409ff3feu, 0x40a3e98fu, 0x40a81254u, 0x40ac422cu, 0x40b0b1ebu,
    0x40b562f5u, 0x40ba54ceu, 0x40bf86afu, 0x40c4f7bbu, 0x40caa6e0u, 0x40d092dau, 0x40d6ba3du,
    0x40dd1b4du, 0x40e3b42au, 0x40ea8298u, 0x40f18424u, 0x40f8b600u, 0x41000a94u, 0x4103cfa2u,
    0x4107af58u, 0x410ba769u, 0x410fb3fau, 0x4113d1c8u, 0x4117fdb8u, 0x411c34a0u, 0x4120733fu,
    0x4124b62eu, 0x4128f9e2u, 0x412d3aa0u, 0x4131748au, 0x4135a394u, 0x4139b7ceu, 0x413d9ca2u,
    0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu,
    0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu,
    0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu,
    0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x413d9b76u, 0x41379479u,
    0x413126d2u, 0x412a592du, 0x412331fdu, 0x411bccf1u, 0x41145d71u, 0x410cef26u, 0x41058cceu,
    0x40fc82a9u, 0x40ee2e5au, 0x40e0302eu, 0x40d29a40u, 0x40c56245u, 0x40b87876u, 0x40abf286u,
    0x409fdebau, 0x409447c8u, 0x408935ceu, 0x407d6661u, 0x40696722u, 0x40566630u, 0x40447596u,
    0x40337f45u, 0x40237fb2u, 0x40147ae2u, 0x40066427u, 0x3ff247d9u, 0x3fd96568u, 0x3fc216fbu,
    0x3fac5958u, 0x3f9828a2u, 0x3f858bfeu, 0x3f68c2a8u, 0x3f49267eu, 0x3f2c2bc2u, 0x3f11c146u,
    0x3ef3b188u, 0x3ec8c95cu, 0x3ea2ae94u, 0x3e814e88u, 0x3e48eaccu, 0x3e17d028u, 0x0u, 0x0u, 0x0u,
    0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x0u, 0x40400b3eu, 0x40c00b3eu, 0x4110086eu, 0x41187e00u,
    0x4111a93bu, 0x410bb6b1u, 0x41066d9bu, 0x4101a5f0u, 0x40fa85a4u, 0x40f25df1u, 0x40eab4e2u,
    0x40e37227u, 0x40dcac1cu, 0x40d64fdeu, 0x40d030fau, 0x40ca4674u, 0x40c48970u, 0x40bef4afu,
    0x40b98446u, 0x40b43556u, 0x40af05e8u, 0x40a9f4c1u, 0x40a50136u, 0x40a02b15u, 0x409b7284u,
    0x4096d7d2u, 0x409258b6u, 0x408df5aau, 0x4089af53u, 0x4085866cu, 0x40817bc4u, 0x407b206au,
    0x40738944u, 0x406c33fau, 0x40652250u, 0x405e5610u, 0x4057d0e5u, 0x40519472u, 0x404ba24au,
    0x4045fbbcu, 0x4040a231u, 0x403b97a2u, 0x4036da6cu, 0x40326a6cu, 0x402e4866u, 0x402a753cu,
    0x4026f208u, 0x4023bfe5u, 0x4020e024u, 0x401e5429u, 0x401c1d58u, 0x401a3d54u, 0x4018b5bdu,
    0x40178885u, 0x4016b7a9u, 0x4016456au, 0x40163446u, 0x4016870cu, 0x401740ceu, 0x4018bda0u,
    0x401b445bu, 0x401eb9a3u, 0x40230b83u, 0x40282e3du, 0x402e1a4bu, 0x4034cafcu, 0x403c3d89u,
    0x4044706bu, 0x404cd596u, 0x4055b19du, 0x405f3d16u, 0x40697913u, 0x40746e9bu, 0x40801071u,
    0x4086493fu, 0x408ce2c2u, 0x4093ddc2u, 0x409b3ab8u, 0x40a2f9b5u, 0x40ab1a81u, 0x40b39c76u,
    0x40bc7eb3u, 0x40c5c973u, 0x40cf7b94u, 0x40d99308u, 0x40e40d00u, 0x40eee5f0u, 0x40fa1976u,
    0x4102d147u, 0x4108bffdu, 0x410ee63du, 0x41153cdcu, 0x411bbc22u, 0x41225d46u, 0x4129198cu,
    0x412fe9eeu, 0x4136c78fu, 0x413da413u, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu,
    0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu,
    0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu,
    0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu,
    0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu,
    0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x41400b3eu, 0x413b887cu, 0x413504f6u,
    0x412e5b05u, 0x41278ee4u, 0x4120a4b8u, 0x4119a5f7u, 0x4112c662u, 0x410c16b6u, 0x4105985au,
    0x40fe9c2eu, 0x40f27595u, 0x40e6c21cu, 0x40db8665u, 0x40d0c631u, 0x40c67e7eu, 0x40bc93a5u,
    0x40b30e27u, 0x40a9f3c1u, 0x40a1474bu, 0x40990a30u, 0x40913e7au, 0x4089e804u, 0x40830174u,
    0x40790f8du, 0x406ce5dau, 0x40618161u, 0x4056de27u, 0x404cf8e5u, 0x4043ceccu, 0x403b5d06u,
    0x4033a175u, 0x402c9a90u, 0x4026471eu, 0x4020a702u, 0x401bb858u, 0x401776d3u, 0x4013e228u,
    0x4010fb1cu, 0x400ec351u, 0x400d3d60u, 0x400c6c98u, 0x400c554eu, 0x400cfcc3u
};
static const uint8_t soft_pad_scene_golden_notes[600] = {
    2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 4, 12, 12, 12, 12, 12, 12, 12,
    12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 4, 4, 4, 4, 4, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 64, 64, 64, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12,
    12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12,
    12, 12, 4, 4, 4, 4, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0
};

static float soft_pad_from_bits(uint32_t bits)
{
    float number;
    (void)memcpy(&number, &bits, sizeof number);
    return number;
}

static uint32_t soft_pad_to_bits(float number)
{
    uint32_t bits;
    (void)memcpy(&bits, &number, sizeof bits);
    return bits;
}

/* Run the stored motion and compare every force with the stored one, bit by bit: a compiler
 * that reorders or fuses operations is seen. Returns 0, or 1 + the tick that differs. */
int soft_pad_selftest(void)
{
    soft_pad_state state;
    soft_pad_init(&state);
    float force_n = 0.0f;
    for (size_t i =
         0; i < sizeof soft_pad_scene_golden_position / sizeof soft_pad_scene_golden_position[0]; i++) {
        const int notes = soft_pad_step(&state,
                                        soft_pad_from_bits(soft_pad_scene_golden_position[i]), 0.0f,
                                        &force_n);
        if (soft_pad_to_bits(force_n) != soft_pad_scene_golden_force[i] || notes !=
            (int)soft_pad_scene_golden_notes[i]) {
            return 1 + (int)i;
        }
    }
    /* A time step that is no number: taken, it would end the watchdog's count for ever. */
    force_n = 0.0f;
    const float no_number = soft_pad_from_bits(0x7fc00000u);
    if (no_number == no_number || soft_pad_idle(&state, no_number, &force_n) !=
        SP_ERROR_TIME_STEP || soft_pad_to_bits(force_n) != 0) {
        return 1 +
            (int)(sizeof soft_pad_scene_golden_position / sizeof soft_pad_scene_golden_position[0]);
    }
    /* Too long a silence: no force any more, whatever comes, until a reset. */
    const float deep_m = soft_pad_from_bits(soft_pad_scene_golden_position[180]);
    int as_planned = (soft_pad_idle(&state, 0.072f, &force_n) & SP_NOTE_LATCHED) &&
        soft_pad_to_bits(force_n) == 0;
    as_planned &= (soft_pad_step(&state, deep_m, 0.0f, &force_n) & SP_NOTE_LATCHED) != 0;
    as_planned &= soft_pad_to_bits(force_n) == 0;
    soft_pad_reset(&state);
    const float first_m = soft_pad_from_bits(soft_pad_scene_golden_position[0]);
    as_planned &= soft_pad_step(&state, first_m, 0.0f, &force_n) ==
        (int)soft_pad_scene_golden_notes[0];
    if (!as_planned) {
        return 1 +
            (int)(sizeof soft_pad_scene_golden_position / sizeof soft_pad_scene_golden_position[0]);
    }
    return 0;
}

#endif

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif
