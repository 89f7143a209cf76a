/* Fast window: approximates a long window of taps by a few direct taps and a few exponentials.
 *
 *     sum of c_k x[n-k] = sum of C_k (x[n-k] - x[n-k-1]) + C_oldest x[oldest]
 *     C_k = c_0 + .. + c_k
 *
 * C_k is direct for the newest rises and a sum of exponentials for the others. An exponential that
 * forgets the sample that leaves its n samples is a pole with a second input:
 *
 *     h[n] = keep h[n-1] + entering rise - keep^n leaving rise
 *
 * Rounding errors decay with the pole, so nothing drifts. */
#ifndef SP_FAST_WINDOW_H
#define SP_FAST_WINDOW_H

#include <stdint.h>

#include "sp_number.h"

/* window: [n_window], newest first, one more than the taps. terms: [n_direct + n_poles + 1], the
 * inputs of sp_weighted_sum: rises, poles, oldest sample. */
static inline void sp_fast_window(const sp_real *keep, const sp_real *leave, uint32_t n_direct,
                                  uint32_t n_poles, const sp_real *window, uint32_t n_window,
                                  sp_real *poles, sp_real *terms)
{
    const sp_real in = window[n_direct] - window[n_direct + 1];
    const sp_real out = window[n_window - 2] - window[n_window - 1];
    for (uint32_t k = 0; k < n_direct; k++) {
        terms[k] = window[k] - window[k + 1];
    }
    for (uint32_t i = 0; i < n_poles; i++) {
        poles[i] = sp_flush_denormal(keep[i] * poles[i] + (in - leave[i] * out));
        terms[n_direct + i] = poles[i];
    }
    terms[n_direct + n_poles] = window[n_window - 2];
}

#endif
