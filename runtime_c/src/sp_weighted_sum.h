/* Weighted sums side by side: out[lane] = sum over k of weights[k][lane] in[k].
 *
 * The weights are stored input by input, lanes padded to whole vectors, so that the compiler
 * vectorises over lanes and no sum is reordered: the same bits with and without vector units. */
#ifndef SP_WEIGHTED_SUM_H
#define SP_WEIGHTED_SUM_H

#include <stdint.h>

#include "sp_real.h"

enum {
    SP_VECTOR_WIDTH = 4 /* lanes are padded to a multiple of this */
};

/* Product of a vector and a matrix whose rows fill whole vector registers. weights:
 * [n_inputs][vector_width]; in: [n_inputs]; out: [vector_width]. */
static inline void sp_weighted_sum(const sp_real *weights, const sp_real *in, uint32_t n_inputs,
                                   uint32_t vector_width, sp_real *out)
{
    for (uint32_t block = 0; block < vector_width; block += SP_VECTOR_WIDTH) {
        sp_real sum[SP_VECTOR_WIDTH] = {0};
        for (uint32_t k = 0; k < n_inputs; k++) {
#pragma GCC unroll 4
            for (uint32_t i = 0; i < SP_VECTOR_WIDTH; i++) {
                sum[i] += weights[k * vector_width + block + i] * in[k];
            }
        }
        for (uint32_t i = 0; i < SP_VECTOR_WIDTH; i++) {
            out[block + i] = sum[i];
        }
    }
}

#endif
