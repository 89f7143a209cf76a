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
/* No warning of what gcc's own intrinsics leave undefined on purpose, and convert
 * where they are macros; nor of the places of trees that are never there. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wsign-conversion"
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

/* ---------------------------------------------------------------------------------- sp_window.h */

/* Window: the newest `length` samples, always contiguous, newest first.
 *
 * Each sample is written twice, `length` apart, so that no tick ever moves the buffer. */

/* Fill all of `samples` (2 x length) with x: the object has rested there for ever. */
static inline void sp_window_fill(float *samples, uint32_t *newest, uint32_t length, float x)
{
    for (uint32_t i = 0; i < 2 * length; i++) {
        samples[i] = x;
    }
    *newest = 0;
}

/* Returns the window with x in front. */
static inline const float *sp_window_push(float *samples, uint32_t *newest, uint32_t length,
                                            float x)
{
    const uint32_t at = (*newest == 0 ? length : *newest) - 1;
    samples[at] = x;
    samples[at + length] = x;
    *newest = at;
    return samples + at;
}

/* ------------------------------------------------------------------------------------ sp_taps.h */

/* Taps: each feature is a window of samples, each weighed by a tap of its own.
 *
 * Sixteen partial sums run side by side and are added in one fixed order: the compiler vectorises
 * them without reordering any sum, so that the bits are the same with and without vector units. */

enum {
    SP_TAPS_SUMS = 16 /* windows are padded to a multiple of this, with taps of 0 */
};

/* taps: [n_features][length]; window: [length]; features: [n_features]. */
static inline void sp_taps(const float *taps, const float *window, uint32_t length,
                           uint32_t n_features, float *features)
{
    for (uint32_t feature = 0; feature < n_features; feature++) {
        const float *tap = taps + feature * length;
        float sum[SP_TAPS_SUMS] = {0};
        for (uint32_t k = 0; k < length; k += SP_TAPS_SUMS) {
#pragma GCC unroll 16
            for (uint32_t i = 0; i < SP_TAPS_SUMS; i++) {
                sum[i] += tap[k + i] * window[k + i];
            }
        }
#pragma GCC unroll 8
        for (uint32_t i = 0; i < 8; i++) {
            sum[i] += sum[i + 8];
        }
#pragma GCC unroll 4
        for (uint32_t i = 0; i < 4; i++) {
            sum[i] += sum[i + 4];
        }
        features[feature] = (sum[0] + sum[2]) + (sum[1] + sum[3]);
    }
}

/* ------------------------------------------------------------------------------------ sp_bins.h */

/* Bins: how many of a feature's sorted thresholds are below it, so that trees compare 16 bits.
 *
 * A feature moves little in a tick: its bin is looked for near the last one, and among all
 * thresholds only where it has left that neighbourhood. Either search halves what is left without a
 * branch that depends on data; its longest way is a constant of the scene. The bin is the same
 * whichever way it was found. */

enum { SP_BINS_NEAR = 31 /* thresholds on either side that are searched first */ };

/* Thresholds below `feature` among those from `bin` on, `left` of them, plus bin. */
static inline uint32_t sp_bins_search(const float *thresholds, uint32_t bin_index, uint32_t left,
                                      float feature)
{
    while (left > 0) {
        const uint32_t half = left - left / 2;
        const uint32_t below = (uint32_t)(thresholds[bin_index + half - 1] < feature);
        bin_index += half & (0u - below);
        left -= half;
    }
    return bin_index;
}

/* thresholds: one feature after the other; feature i has those from starts[i] to starts[i + 1].
 * last: [n_features], the bins of the last tick, and those of this one afterwards. */
static inline void sp_bins(const float *thresholds, const uint32_t *starts, uint32_t n_features,
                           const float *features, uint32_t *last)
{
    for (uint32_t i = 0; i < n_features; i++) {
        const float feature = (float)features[i];
        const float *own = thresholds + starts[i];
        const uint32_t n = starts[i + 1] - starts[i];
        const uint32_t from = last[i] > SP_BINS_NEAR ? last[i] - SP_BINS_NEAR : 0;
        const uint32_t begin_max = n > 2 * SP_BINS_NEAR ? n - 2 * SP_BINS_NEAR : 0;
        const uint32_t begin = from < begin_max ? from : begin_max;
        const uint32_t end = begin + (n - begin_max);
        const int near =
            (begin == 0 || own[begin - 1] < feature) && (end == n || !(own[end] < feature));
        last[i] = near ? sp_bins_search(own, begin, n - begin_max, feature)
                       : sp_bins_search(own, 0, n, feature);
    }
}

/* ---------------------------------------------------------------------------------- sp_forest.h */

/* Forest: the sum of the leaves that a feature vector reaches, one in each tree.
 *
 * Features come as bins (whole numbers), so that a threshold is 16 bits and a node 4 bytes.
 * A node sends a bin above its own to the right. The first SP_FOREST_LEVELS levels of all trees
 * are complete and lie side by side, heap position by heap position; a leaf above them sends
 * everything to the left. Below, `step` holds the way to the left child in nodes, and the feature's
 * slot in its low bits; the right child is next to the left one, and three levels lie together. A
 * leaf's step is 0 and its bin is its value in steps: slot 0 has bin 0, so that traversing on stays
 * there. Many trees are therefore traversed at once, without a branch that depends on data, and
 * wait for memory together. Sums are integers: the same in any order, and on any processor. */

enum {
    SP_FOREST_SLOT_BITS = 4,
    SP_FOREST_SLOTS = 1 << SP_FOREST_SLOT_BITS,
    SP_FOREST_LEVELS = 4,
    SP_FOREST_ENTRIES = 1 << SP_FOREST_LEVELS, /* of a tree, below its first levels */
    SP_FOREST_UNCHECKED = 3                    /* levels traversed before looking for inner nodes */
};

/* Trees traversed at once: as many as hide the wait for memory; one where there is no cache. */
#if defined(__x86_64__) || defined(__aarch64__) || defined(_M_X64)
enum { SP_FOREST_TRAVERSALS = 20, SP_FOREST_REST = 10 };
#elif defined(__wasm__) /* of such a processor, with fewer registers */
enum { SP_FOREST_TRAVERSALS = 10, SP_FOREST_REST = 10 };
#else
enum { SP_FOREST_TRAVERSALS = 1, SP_FOREST_REST = 1 };
#endif

typedef struct {
    uint16_t step;
    uint16_t bin_index;
} sp_forest_node;

typedef struct {
    const sp_forest_node *top;   /* [SP_FOREST_ENTRIES - 1][n_padded] */
    const sp_forest_node *nodes; /* tree after tree, each with its SP_FOREST_ENTRIES first */
    const uint32_t *roots;       /* [n_padded]: first entry of each tree */
    uint32_t n_trees;
    uint32_t n_padded; /* trees and padding: every way of traversal finds whole groups */
} sp_forest;

static inline uint32_t sp_forest_right(const sp_forest_node *node, const uint32_t *bins)
{
    /* 1 where the feature's bin is greater, without a flag: both are far below 2^31. */
    return (node->bin_index - bins[node->step & (SP_FOREST_SLOTS - 1)]) >> 31;
}

/* Sum over the `trees` trees from `tree` on; trees is a constant where this is inlined. */
static inline uint32_t sp_forest_traverse(const sp_forest *forest, uint32_t tree, uint32_t trees,
                                          const uint32_t *bins)
{
    uint32_t heap[SP_FOREST_TRAVERSALS];
#pragma GCC unroll 20
    for (uint32_t i = 0; i < trees; i++) {
        heap[i] = 1;
    }
#pragma GCC unroll 1
    for (uint32_t level = 0; level < SP_FOREST_LEVELS; level++) {
#pragma GCC unroll 20
        for (uint32_t i = 0; i < trees; i++) {
            const sp_forest_node *node = forest->top + (heap[i] - 1) * forest->n_padded + tree + i;
            heap[i] = 2 * heap[i] + sp_forest_right(node, bins);
        }
    }
    const sp_forest_node *at[SP_FOREST_TRAVERSALS];
#pragma GCC unroll 20
    for (uint32_t i = 0; i < trees; i++) {
        at[i] = forest->nodes + forest->roots[tree + i] + (heap[i] - SP_FOREST_ENTRIES);
    }
    uint32_t steps;
    do {
        steps = 0;
#pragma GCC unroll 3
        for (uint32_t level = 0; level < SP_FOREST_UNCHECKED; level++) {
#pragma GCC unroll 20
            for (uint32_t i = 0; i < trees; i++) {
                //@ split at[i] - forest->nodes;
                const uint32_t right = sp_forest_right(at[i], bins);
                const uint32_t step = at[i]->step;
                steps |= level + 1 == SP_FOREST_UNCHECKED ? step : 0;
                at[i] += (step >> SP_FOREST_SLOT_BITS) + right;
            }
        }
    } while (steps);
    uint32_t sum = 0;
#pragma GCC unroll 20
    for (uint32_t i = 0; i < trees; i++) {
        sum += at[i]->bin_index;
    }
    return sum;
}

/* bins: [SP_FOREST_SLOTS], each below 2^16, the first one 0. Returns steps. */
static inline uint32_t sp_forest_sum(const sp_forest *forest, const uint32_t *bins)
{
    uint32_t sum = 0;
    uint32_t tree = 0;
    for (; tree + SP_FOREST_TRAVERSALS <= forest->n_trees; tree += SP_FOREST_TRAVERSALS) {
        sum += sp_forest_traverse(forest, tree, SP_FOREST_TRAVERSALS, bins);
    }
    for (; tree < forest->n_trees; tree += SP_FOREST_REST) {
        sum += sp_forest_traverse(forest, tree, SP_FOREST_REST, bins);
    }
    return sum;
}

/* ------------------------------------------------------------------------------ sp_forest_x86.h */

/* The forest of sp_forest.h on AVX2 and AVX-512: a lane a tree.
 *
 * The first levels need no look-up: whole rows of them are loaded and blended. Below, one gather
 * fetches the nodes of all lanes. As many groups of lanes are traversed at once as there are
 * registers for: what a tick waits for is memory, and it waits for all of them together. A node is
 * read as 32 bits: the step low, the bin high. */

/* Emitted C lists this header for every processor of a PC: for others it holds nothing. */
#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>

enum { SP_FOREST_GROUPS = 7 }; /* traversed at once; in a last round some may be idle */

#define SP_TARGET_AVX512 __attribute__((target("avx512f,avx512bw,avx512vl")))
#define SP_TARGET_AVX2 __attribute__((target("avx2")))

/* Lanes whose feature's bin is above the node's. Bins are in the upper half of their 32 bits; the
 * step below a node's never reaches the next bin, so that it need not be cut off. */
SP_TARGET_AVX512 static inline __mmask16 sp_forest_right512(__m512i node, __m512i bins)
{
    return _mm512_cmpgt_epu32_mask(_mm512_permutexvar_epi32(node, bins), node);
}

SP_TARGET_AVX512 static inline __m512i sp_forest_enter512(const sp_forest *forest, uint32_t tree,
                                                          __m512i bins)
{
    const uint32_t row = forest->n_padded;
    const sp_forest_node *top = forest->top + tree;
#define SP_ROW(heap) _mm512_loadu_si512(top + ((heap) - 1) * row)
#define SP_EITHER(left, right, k) _mm512_mask_mov_epi32(left, k, right)
    const __mmask16 a = sp_forest_right512(SP_ROW(1), bins);
    const __mmask16 b = sp_forest_right512(SP_EITHER(SP_ROW(2), SP_ROW(3), a), bins);
    const __m512i third =
        SP_EITHER(SP_EITHER(SP_ROW(4), SP_ROW(6), a), SP_EITHER(SP_ROW(5), SP_ROW(7), a), b);
    const __mmask16 c = sp_forest_right512(third, bins);
    const __m512i left =
        SP_EITHER(SP_EITHER(SP_ROW(8), SP_ROW(12), a), SP_EITHER(SP_ROW(10), SP_ROW(14), a), b);
    const __m512i right =
        SP_EITHER(SP_EITHER(SP_ROW(9), SP_ROW(13), a), SP_EITHER(SP_ROW(11), SP_ROW(15), a), b);
    const __mmask16 d = sp_forest_right512(SP_EITHER(left, right, c), bins);
#undef SP_ROW
#undef SP_EITHER
    __m512i at = _mm512_loadu_si512(forest->roots + tree);
    at = _mm512_mask_add_epi32(at, a, at, _mm512_set1_epi32(8));
    at = _mm512_mask_add_epi32(at, b, at, _mm512_set1_epi32(4));
    at = _mm512_mask_add_epi32(at, c, at, _mm512_set1_epi32(2));
    return _mm512_mask_add_epi32(at, d, at, _mm512_set1_epi32(1));
}

SP_TARGET_AVX512 static inline uint32_t sp_forest_avx512(const sp_forest *forest,
                                                         const uint32_t *bins)
{
    const __m512i feature = _mm512_slli_epi32(_mm512_loadu_si512(bins), 16);
    const __m512i one = _mm512_set1_epi32(1);
    __m512i sum = _mm512_setzero_si512();
    for (uint32_t first = 0; first < forest->n_trees; first += 16 * SP_FOREST_GROUPS) {
        __m512i at[SP_FOREST_GROUPS];
        __m512i node[SP_FOREST_GROUPS];
        const uint32_t groups = (forest->n_trees - first + 15) / 16;
#pragma GCC unroll 7
        for (uint32_t g = 0; g < SP_FOREST_GROUPS; g++) {
            node[g] = _mm512_setzero_si512();
            at[g] = g < groups ? sp_forest_enter512(forest, first + 16 * g, feature) : node[g];
        }
        __mmask16 inner;
        do {
            __m512i steps = _mm512_setzero_si512();
#pragma GCC unroll 7
            for (uint32_t g = 0; g < SP_FOREST_GROUPS; g++) {
                if (g < groups) {
                    node[g] = _mm512_i32gather_epi32(at[g], forest->nodes, 4);
                    const __m512i step = _mm512_srli_epi32(_mm512_slli_epi32(node[g], 16), 20);
                    const __mmask16 right = sp_forest_right512(node[g], feature);
                    steps = _mm512_or_si512(steps, step);
                    at[g] = _mm512_add_epi32(at[g], step);
                    at[g] = _mm512_mask_add_epi32(at[g], right, at[g], one);
                }
            }
            inner = _mm512_test_epi32_mask(steps, steps);
        } while (inner);
#pragma GCC unroll 7
        for (uint32_t g = 0; g < SP_FOREST_GROUPS; g++) {
            const __m512i value = _mm512_srli_epi32(node[g], 16);
            sum = _mm512_add_epi32(sum, value);
        }
    }
    return (uint32_t)_mm512_reduce_add_epi32(sum);
}

typedef struct {
    __m256i low;
    __m256i high;
} sp_forest_ranks256;

/* All bits of the lanes whose feature's bin is above the node's. */
SP_TARGET_AVX2 static inline __m256i sp_forest_right256(__m256i node, sp_forest_ranks256 bins)
{
    const __m256 low = _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(bins.low, node));
    const __m256 high = _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(bins.high, node));
    const __m256 which = _mm256_castsi256_ps(_mm256_slli_epi32(node, 28));
    const __m256i feature = _mm256_castps_si256(_mm256_blendv_ps(low, high, which));
    return _mm256_cmpgt_epi32(feature, _mm256_srli_epi32(node, 16));
}

SP_TARGET_AVX2 static inline __m256i sp_forest_load256(const void *from)
{
    return _mm256_loadu_si256((const __m256i *)from);
}

SP_TARGET_AVX2 static inline __m256i sp_forest_enter256(const sp_forest *forest, uint32_t tree,
                                                        sp_forest_ranks256 bins)
{
    const uint32_t row = forest->n_padded;
    const sp_forest_node *top = forest->top + tree;
#define SP_ROW(heap) sp_forest_load256(top + ((heap) - 1) * row)
#define SP_EITHER(left, right, k) _mm256_blendv_epi8(left, right, k)
    const __m256i a = sp_forest_right256(SP_ROW(1), bins);
    const __m256i b = sp_forest_right256(SP_EITHER(SP_ROW(2), SP_ROW(3), a), bins);
    const __m256i third =
        SP_EITHER(SP_EITHER(SP_ROW(4), SP_ROW(6), a), SP_EITHER(SP_ROW(5), SP_ROW(7), a), b);
    const __m256i c = sp_forest_right256(third, bins);
    const __m256i left =
        SP_EITHER(SP_EITHER(SP_ROW(8), SP_ROW(12), a), SP_EITHER(SP_ROW(10), SP_ROW(14), a), b);
    const __m256i right =
        SP_EITHER(SP_EITHER(SP_ROW(9), SP_ROW(13), a), SP_EITHER(SP_ROW(11), SP_ROW(15), a), b);
    const __m256i d = sp_forest_right256(SP_EITHER(left, right, c), bins);
#undef SP_ROW
#undef SP_EITHER
    /* A mask is -1: entry = 8 a + 4 b + 2 c + d, taken away with its sign. */
    const __m256i ab = _mm256_add_epi32(_mm256_add_epi32(a, a), b);
    const __m256i abc = _mm256_add_epi32(_mm256_add_epi32(ab, ab), c);
    const __m256i entry = _mm256_add_epi32(_mm256_add_epi32(abc, abc), d);
    return _mm256_sub_epi32(sp_forest_load256(forest->roots + tree), entry);
}

SP_TARGET_AVX2 static inline uint32_t sp_forest_avx2(const sp_forest *forest, const uint32_t *bins)
{
    const sp_forest_ranks256 feature = {sp_forest_load256(bins), sp_forest_load256(bins + 8)};
    __m256i sum = _mm256_setzero_si256();
    for (uint32_t first = 0; first < forest->n_trees; first += 8 * SP_FOREST_GROUPS) {
        __m256i at[SP_FOREST_GROUPS];
        __m256i node[SP_FOREST_GROUPS];
        const uint32_t groups = (forest->n_trees - first + 7) / 8;
#pragma GCC unroll 7
        for (uint32_t g = 0; g < SP_FOREST_GROUPS; g++) {
            node[g] = _mm256_setzero_si256();
            at[g] = g < groups ? sp_forest_enter256(forest, first + 8 * g, feature) : node[g];
        }
        __m256i steps;
        do {
            steps = _mm256_setzero_si256();
#pragma GCC unroll 7
            for (uint32_t g = 0; g < SP_FOREST_GROUPS; g++) {
                if (g < groups) {
                    node[g] =
                        _mm256_i32gather_epi32((const int *)(const void *)forest->nodes, at[g], 4);
                    const __m256i step = _mm256_srli_epi32(_mm256_slli_epi32(node[g], 16), 20);
                    const __m256i right = sp_forest_right256(node[g], feature);
                    steps = _mm256_or_si256(steps, step);
                    at[g] = _mm256_sub_epi32(_mm256_add_epi32(at[g], step), right);
                }
            }
        } while (!_mm256_testz_si256(steps, steps));
#pragma GCC unroll 7
        for (uint32_t g = 0; g < SP_FOREST_GROUPS; g++) {
            const __m256i value = _mm256_srli_epi32(node[g], 16);
            sum = _mm256_add_epi32(sum, value);
        }
    }
    uint32_t lanes[8];
    _mm256_storeu_si256((__m256i *)(void *)lanes, sum);
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
           ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

#endif

/* ----------------------------------------------------------------------------- sp_forest_simd.h */

/* The forest of sp_forest.h with the vector units that the processor turns out to have.
 *
 * Chosen once, in sp_init, and the same sum in every case. A vector variant for another processor
 * goes here: beside the x86-64 ones, with a number of its own. SP_SIMD caps the choice; benchmarks
 * and tests set it. */

enum { SP_SIMD_NONE, SP_SIMD_AVX2, SP_SIMD_AVX512 };

#ifndef SP_SIMD
#define SP_SIMD SP_SIMD_AVX512
#endif

#if defined(__x86_64__) && defined(__GNUC__)

static inline uint32_t sp_forest_simd(void)
{
    if (SP_SIMD >= SP_SIMD_AVX512 && __builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl")) {
        return SP_SIMD_AVX512;
    }
    return SP_SIMD >= SP_SIMD_AVX2 && __builtin_cpu_supports("avx2") ? SP_SIMD_AVX2 : SP_SIMD_NONE;
}

static inline uint32_t sp_forest_fastest(const sp_forest *forest, const uint32_t *bins,
                                         uint32_t simd)
{
    return simd == SP_SIMD_AVX512 ? sp_forest_avx512(forest, bins)
           : simd == SP_SIMD_AVX2 ? sp_forest_avx2(forest, bins)
                                  : sp_forest_sum(forest, bins);
}

#else

static inline uint32_t sp_forest_simd(void)
{
    return SP_SIMD_NONE;
}

static inline uint32_t sp_forest_fastest(const sp_forest *forest, const uint32_t *bins,
                                         uint32_t simd)
{
    (void)simd;
    return sp_forest_sum(forest, bins);
}

#endif

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
    0.001f, /* jump_m */
    -10.0f, /* min_m */
    0.1f,   /* max_m */
    5,      /* resync_ticks */
};
static const sp_range_config range = {
    0.0f,  /* min_m */
    0.01f, /* max_m */
};
static const sp_output_config output = {
    0.0f,  /* min_n */
    12.0f, /* max_n */
    3.0f,  /* slew_n */
    0.02f, /* rise */
    0.1f,  /* back */
    1.5f,  /* fall_n */
};
static const float per_onset = 10000.0f;

enum {
    N_TAPS = 16,
    N_ORDERS = 1
};
/* c(r, k), newest first, 4 and padding: a row each of 0.5. */
static const float taps[1 * 16] = {
    32.0f, -16.0f, -4.0f, -2.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
    0.0f
};

enum {
    N_FEATURES = 1
};
static const float leaf_step_n = 0.0001373312f;
static const float forest_bias_n = 1.0f;
/* Sorted thresholds of each feature. */
static const float thresholds[2] = {
    0.02f, 0.06999999f
};
static const uint32_t threshold_starts[2] = {
    0u, 2u
};
/* The first levels of all trees side by side: step, bin (sp_forest.h). */
static const sp_forest_node forest_top[240] = {
    {1, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {1, 1}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}
};
/* Below, tree after tree. */
static const sp_forest_node forest_nodes[17] = {
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 21845}, {0, 0}, {0, 0},
    {0, 0}, {0, 65535}, {0, 0}, {0, 0}, {0, 0}, {0, 0}
};
static const uint32_t forest_roots[16] = {
    0u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u
};
static const sp_forest forest = {
    forest_top,   /* top */
    forest_nodes, /* nodes */
    forest_roots, /* roots */
    1,            /* n_trees */
    16,           /* n_padded */
};

/* ---------------------------------------------------- the tick, and the functions of the header */

/* A position is true without a history: the object has rested there for ever. */
static void restart(sp_state *state, float position)
{
    const float penetration = position > (float)0 ? position : (float)0;
    int ignored = 0;
    const float clipped = sp_range_clip(&range, penetration, &ignored);
    sp_window_fill(state->history, &state->newest, N_TAPS, clipped);
    sp_output_restart(&output, &state->output);
}

/* One tick with the tool at `position`; returns the model's force, N. */
SP_APART float tick(sp_state *state, float position, int *notes)
{
    const float penetration = position > (float)0 ? position : (float)0;
    const float clipped = sp_range_clip(&range, penetration, notes);
    const float *window =
        sp_window_push(state->history, &state->newest, N_TAPS, clipped);
    float force = (float)0;
    if (position > (float)0) {
        float features[1];
        sp_taps(taps, window, N_TAPS, N_ORDERS, features);
        uint32_t bins[SP_FOREST_SLOTS] = {0};
        sp_bins(thresholds, threshold_starts, N_FEATURES, features, state->bins);
        for (uint32_t i = 0; i < N_FEATURES; i++) {
            bins[i + 1] = state->bins[i];
        }
        const uint32_t leaf_sum = sp_forest_fastest(&forest, bins, state->simd);
        const float model_n = forest_bias_n + (float)leaf_sum * leaf_step_n;
        force = model_n;
        force = sp_contact_onset(per_onset, position, force);
    } else {
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
                     uint32_t left)
{
    for (; left > 0; left--) {
        const float at = sp_guard_within(&guard, position - (float)left * step);
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
        make_up(state, position, way / ticks, left);
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
        state->simd = sp_forest_simd();
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
    return "{\"springpot\": \"0.1.0\", \"hash\": \"609f54482b9bb9444b6dddeefef62a1f4da4f6237e89f05f56a8b597417dac37\", \"scene\": \"smallest\", \"model\": \"rf-fd\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [0.0, 0.01], \"speed_mps\": 0.1, \"force_n\": [0.0, 10.0]}}";
}

/* ------------------------------------------------------------------------------------ self-test */

