/* Forest of sp_forest.h with the vector units that the processor has at run time.
 *
 * sp_init chooses once; the sum is the same in every case. A variant for another processor goes
 * here, beside the x86-64 ones, with a new number. SP_SIMD caps the choice, for benchmarks and
 * tests. */
#ifndef SP_FOREST_SIMD_H
#define SP_FOREST_SIMD_H

#include "sp_forest.h"

enum { SP_SIMD_NONE, SP_SIMD_AVX2, SP_SIMD_AVX512 };

#ifndef SP_SIMD
#define SP_SIMD SP_SIMD_AVX512
#endif

#if defined(__x86_64__) && defined(__GNUC__)
#include "sp_forest_x86.h"

/* Widest vector instructions that both this build and this processor have. */
static inline uint32_t sp_forest_simd(void)
{
    if (SP_SIMD >= SP_SIMD_AVX512 && __builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl")) {
        return SP_SIMD_AVX512;
    }
    return SP_SIMD >= SP_SIMD_AVX2 && __builtin_cpu_supports("avx2") ? SP_SIMD_AVX2 : SP_SIMD_NONE;
}

static inline uint32_t sp_forest_sum_simd(const sp_forest *forest, const uint32_t *bins,
                                          uint32_t simd)
{
    return simd == SP_SIMD_AVX512 ? sp_forest_avx512(forest, bins)
           : simd == SP_SIMD_AVX2 ? sp_forest_avx2(forest, bins)
                                  : sp_forest_sum(forest, bins);
}

#else

/* Widest vector instructions that both this build and this processor have. */
static inline uint32_t sp_forest_simd(void)
{
    return SP_SIMD_NONE;
}

static inline uint32_t sp_forest_sum_simd(const sp_forest *forest, const uint32_t *bins,
                                          uint32_t simd)
{
    (void)simd;
    return sp_forest_sum(forest, bins);
}

#endif

#endif
