/* Rounding: a feature in whole steps of 16 bits, for a forest that was fitted on such features. */
#ifndef SP_QUANTISE_H
#define SP_QUANTISE_H

#include <stdint.h>

#include "sp_real.h"

/* Within 0 .. 65535; to the nearest step. */
static inline uint32_t sp_quantise(sp_real feature, float lower, float per_step)
{
    const float steps = ((float)feature - lower) * per_step + 0.5f;
    const float below = steps < 65535.0f ? steps : 65535.0f;
    return (uint32_t)(below > 0.0f ? below : 0.0f);
}

#endif
