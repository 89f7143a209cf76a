/* Velocity by first-order adaptive windowing (Janabi-Sharifi, Hayward, Chen 2000, end-fit): the
 * slope of the longest line from the newest sample that passes every sample within the noise band,
 * at most `length` samples back. Slow motion gives a long and smooth window, fast motion a short
 * one.
 *
 * The band of sample j allows an interval of slopes. The search intersects these intervals in one
 * pass: at most `length` steps a tick. */
#ifndef SP_VELOCITY_H
#define SP_VELOCITY_H

#include <stdint.h>

#include "sp_real.h"

/* Velocity by first-order adaptive windowing (Janabi-Sharifi, Hayward, Chen 2000), m/s: the
 * slope over the longest window whose samples all lie within band_m of a line. window: newest
 * first, length + 1 samples; per_step[j] = 1/((j + 1) dt), 1/s. */
static inline sp_real sp_velocity_foaw(const sp_real *window, const sp_real *per_step,
                                       uint32_t length, sp_real band_m)
{
    sp_real slope = (sp_real)0;
    sp_real lower = -SP_REAL_MAX;
    sp_real upper = SP_REAL_MAX;
    for (uint32_t j = 0; j < length; j++) {
        const sp_real rise = window[0] - window[j + 1];
        const sp_real candidate = rise * per_step[j];
        if (!(candidate >= lower && candidate <= upper)) {
            break;
        }
        slope = candidate;
        const sp_real low = (rise - band_m) * per_step[j];
        const sp_real high = (rise + band_m) * per_step[j];
        lower = low > lower ? low : lower;
        upper = high < upper ? high : upper;
    }
    return slope;
}

#endif
