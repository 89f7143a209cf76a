/* Cubic radial basis functions with a linear tail, on standardised features z:
 *
 *     force = sum over centers of weight |z - center|^3 + tail_0 + tail z
 *
 * Centers are stored feature by feature. Eight partial sums run side by side and are added in one
 * fixed order: the same bits with and without vector units. */
#ifndef SP_RBF_H
#define SP_RBF_H

#include <stdint.h>

#include "sp_number.h"

enum {
    SP_RBF_WIDTH = 8 /* centers are padded to a multiple of this, with weight 0 */
};

/* Clip x to the trained range, then scale it to mean 0 and scale 1. */
static inline sp_real sp_rbf_standardise(sp_real x, sp_real lower, sp_real upper, sp_real mean,
                                         sp_real per_scale)
{
    const sp_real below = x < upper ? x : upper;
    const sp_real inside = below > lower ? below : lower;
    return (inside - mean) * per_scale;
}

/* Force of radial basis functions, N: cubes of the distance between the scaled features z and
 * the centres, and a linear tail. z: [2]; centers: [2][n_centers]; weights: [n_centers]; tail:
 * [3]. */
static inline sp_real sp_rbf_force(const sp_real *z, const sp_real *centers, const sp_real *weights,
                                   uint32_t n_centers, const sp_real *tail)
{
    sp_real sum[SP_RBF_WIDTH] = {0};
    for (uint32_t block = 0; block < n_centers; block += SP_RBF_WIDTH) {
#pragma GCC unroll 8
        for (uint32_t i = 0; i < SP_RBF_WIDTH; i++) {
            const sp_real d0 = z[0] - centers[block + i];
            const sp_real d1 = z[1] - centers[n_centers + block + i];
            const sp_real square = d0 * d0 + d1 * d1;
            sum[i] += weights[block + i] * (square * sp_sqrt(square));
        }
    }
    const sp_real radial =
        ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
    return radial + (tail[0] + (tail[1] * z[0] + tail[2] * z[1]));
}

#endif
