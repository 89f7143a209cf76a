/* Quantisation: bin of 16 bits of a feature, for a forest that was fitted on such bins. */
#ifndef SP_QUANTISE_H
#define SP_QUANTISE_H

#include <stdint.h>

#include "sp_real.h"

/* Returns the nearest bin, 0 .. 65535. */
static inline uint32_t sp_quantise(sp_real feature, float feature_min, float bins_per_unit)
{
    const float bin = ((float)feature - feature_min) * bins_per_unit + 0.5f;
    const float capped = bin < 65535.0f ? bin : 65535.0f;
    return (uint32_t)(capped > 0.0f ? capped : 0.0f);
}

#endif
