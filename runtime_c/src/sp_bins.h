/* Bins: how many of a feature's sorted thresholds are below it, so that trees compare 16 bits.
 *
 * A feature moves little in a tick: its bin is looked for near the last one, and among all
 * thresholds only where it has left that neighbourhood. Either search halves what is left without a
 * branch that depends on data; its longest way is a constant of the scene. The bin is the same
 * whichever way it was found. */
#ifndef SP_BINS_H
#define SP_BINS_H

#include <stdint.h>

#include "sp_real.h"

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
                           const sp_real *features, uint32_t *last)
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

#endif
