/* Taps: each feature is the weighted sum of a window of samples.
 *
 * Sixteen partial sums run side by side and are added in one fixed order. The compiler vectorises
 * them without reordering a sum, so the bits are the same with and without vector units. */
#ifndef SP_TAPS_H
#define SP_TAPS_H

#include <stdint.h>

#include "sp_real.h"

enum {
    SP_TAPS_LANES = 16 /* windows are padded to a multiple of this, with taps of 0 */
};

/* Fractional derivatives as weighted sums over a window (Grunwald-Letnikov), added in a fixed
 * order that vectors keep too. taps: [n_features][length]; window: [length]; features:
 * [n_features]. */
static inline void sp_taps(const sp_real *taps, const sp_real *window, uint32_t length,
                           uint32_t n_features, sp_real *features)
{
    for (uint32_t feature = 0; feature < n_features; feature++) {
        const sp_real *tap = taps + feature * length;
        sp_real sum[SP_TAPS_LANES] = {0};
        for (uint32_t k = 0; k < length; k += SP_TAPS_LANES) {
#pragma GCC unroll 16
            for (uint32_t i = 0; i < SP_TAPS_LANES; i++) {
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

#endif
