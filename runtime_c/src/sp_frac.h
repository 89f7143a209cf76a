/* Fractional filter bank: D^r x[n] = sum over k of c(r, k) x[n - k] (Grünwald-Letnikov; the
 * paper's equation (16), sampled at t - k h).
 *
 * The taps are stored tap by tap, one lane for each order, so that lanes vectorise and no sum is
 * reordered: the same bits with and without vector units. */
#ifndef SP_FRAC_H
#define SP_FRAC_H

#include <stdint.h>

#include "sp_real.h"

enum {
    SP_FRAC_LANES = 4 /* orders are padded to a multiple of this */
};

/* taps: [length][lanes]; window: newest first; derivative: [lanes], m/s^r. */
static inline void sp_frac_bank(const sp_real *taps, const sp_real *window, uint32_t length,
                                uint32_t lanes, sp_real *derivative)
{
    for (uint32_t block = 0; block < lanes; block += SP_FRAC_LANES) {
        sp_real sum[SP_FRAC_LANES] = {0};
        for (uint32_t k = 0; k < length; k++) {
#pragma GCC unroll 4
            for (uint32_t i = 0; i < SP_FRAC_LANES; i++) {
                sum[i] += taps[k * lanes + block + i] * window[k];
            }
        }
#pragma GCC unroll 4
        for (uint32_t i = 0; i < SP_FRAC_LANES; i++) {
            derivative[block + i] = sum[i];
        }
    }
}

#endif
