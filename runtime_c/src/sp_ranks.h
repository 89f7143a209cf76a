/* Ranks: how many of a feature's sorted thresholds are below it, so that trees compare 16 bits.
 *
 * A search by halves without a branch that depends on data; its length is a constant of the scene.
 * All features are searched side by side and wait for memory together. */
#ifndef SP_RANKS_H
#define SP_RANKS_H

#include <stdint.h>

#include "sp_real.h"

/* thresholds: one feature after the other; feature i has those from starts[i] to starts[i + 1].
 * ranks: [n_features]. */
static inline void sp_ranks(const float *thresholds, const uint32_t *starts, uint32_t n_features,
                            const sp_real *features, uint32_t *ranks)
{
    for (uint32_t i = 0; i < n_features; i++) {
        const float feature = (float)features[i];
        const float *first = thresholds + starts[i];
        uint32_t left = starts[i + 1] - starts[i];
        uint32_t rank = 0;
        while (left > 0) {
            const uint32_t half = left - left / 2;
            const uint32_t below = (uint32_t)(first[rank + half - 1] < feature);
            rank += half & (0u - below);
            left -= half;
        }
        ranks[i] = rank;
    }
}

#endif
