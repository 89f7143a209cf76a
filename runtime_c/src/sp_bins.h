/* Bins: the number of a feature's sorted thresholds below the feature, so that trees compare 16
 * bits.
 *
 * A feature moves little in a tick. So its bin is searched near the last one first, and among all
 * thresholds only if it has left that neighbourhood. Both searches halve the range without a branch
 * that depends on data, in a number of steps that the scene fixes, and find the same bin. */
#ifndef SP_BINS_H
#define SP_BINS_H

#include <stdint.h>

#include "sp_real.h"

enum { SP_BINS_SEARCH_RADIUS = 31 /* thresholds on either side that are searched first */ };

/* Binary search without branches: count the thresholds below `feature` among the `count` ones
 * from bin_index on; returns bin_index plus that count. */
static inline uint32_t sp_bins_search(const float *thresholds, uint32_t bin_index, uint32_t count,
                                      float feature)
{
    while (count > 0) {
        const uint32_t half = count - count / 2;
        const uint32_t below = (uint32_t)(thresholds[bin_index + half - 1] < feature);
        bin_index += half & (0u - below);
        count -= half;
    }
    return bin_index;
}

/* Replace each feature by its rank among the forest's thresholds. A feature moves little in a
 * tick, so a search near the last rank comes first. thresholds: one feature after the other;
 * feature i has those from starts[i] to starts[i + 1]. bins: [n_features], of the last tick;
 * then of this one. */
static inline void sp_bins(const float *thresholds, const uint32_t *starts, uint32_t n_features,
                           const sp_real *features, uint32_t *bins)
{
    for (uint32_t i = 0; i < n_features; i++) {
        const float feature = (float)features[i];
        const float *feature_thresholds = thresholds + starts[i];
        const uint32_t n = starts[i + 1] - starts[i];
        const uint32_t from = bins[i] > SP_BINS_SEARCH_RADIUS ? bins[i] - SP_BINS_SEARCH_RADIUS : 0;
        const uint32_t begin_max =
            n > 2 * SP_BINS_SEARCH_RADIUS ? n - 2 * SP_BINS_SEARCH_RADIUS : 0;
        const uint32_t begin = from < begin_max ? from : begin_max;
        const uint32_t end = begin + (n - begin_max);
        const int near = (begin == 0 || feature_thresholds[begin - 1] < feature) &&
                         (end == n || !(feature_thresholds[end] < feature));
        bins[i] = near ? sp_bins_search(feature_thresholds, begin, n - begin_max, feature)
                       : sp_bins_search(feature_thresholds, 0, n, feature);
    }
}

#endif
