/* Forest of sp_forest.h on AVX2 and AVX-512: one tree in each lane.
 *
 * The first levels need no look-up: whole rows are loaded and blended. Below, one gather fetches
 * the nodes of all lanes. As many groups of lanes are traversed at once as the registers hold, so
 * that their waits for memory overlap. A node is read as 32 bits: the step low, the bin high. */
#ifndef SP_FOREST_X86_H
#define SP_FOREST_X86_H

/* Emitted C lists this header for every processor of a PC: for others it holds nothing. */
#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>

#include "sp_forest.h"

enum { SP_FOREST_GROUPS = 7 }; /* traversed at once; in a last round some may be idle */

#define SP_TARGET_AVX512 __attribute__((target("avx512f,avx512bw,avx512vl")))
#define SP_TARGET_AVX2 __attribute__((target("avx2")))

/* Lanes in which the feature's bin is above the node's. Bins are in the upper half of their 32
 * bits; the step in the lower half never reaches the next bin, so it need not be masked. */
SP_TARGET_AVX512 static inline __mmask16 sp_forest_right512(__m512i node, __m512i bins)
{
    return _mm512_cmpgt_epu32_mask(_mm512_permutexvar_epi32(node, bins), node);
}

/* Pass the top four levels of 16 trees at once; returns the index of the node below. Whole rows
 * are loaded and chosen by masks. */
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

/* Sum of the leaves of all trees, in leaf steps: sp_forest_sum in vectors of 16 trees. */
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

/* All bits of the lanes where the feature's bin is above the node's. */
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

/* Pass the top four levels of 8 trees at once; returns the index of the node below. */
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

/* Sum of the leaves of all trees, in leaf steps: sp_forest_sum in vectors of 8 trees. */
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

#endif
