/* Trained range: clips the depth for models that cannot extrapolate. */
#ifndef SP_RANGE_H
#define SP_RANGE_H

#include "sp_notes.h"
#include "sp_real.h"

typedef struct {
    sp_real min_m;
    sp_real max_m;
} sp_range_config;

/* Position within the range of training, m; beyond it the nearest end, with a note. */
static inline sp_real sp_range_clip(const sp_range_config *config, sp_real x, int *notes)
{
    if (x > config->max_m) {
        *notes |= SP_NOTE_OUTSIDE;
        return config->max_m;
    }
    if (x < config->min_m) {
        *notes |= SP_NOTE_OUTSIDE;
        return config->min_m;
    }
    return x;
}

/* Scale the force beyond the range of training down to 0 over 1/fade_per_m (m), for scenes that
 * render nothing outside. */
static inline sp_real sp_range_fade(const sp_range_config *config, sp_real fade_per_m, sp_real x,
                                    sp_real force_n)
{
    const sp_real above = x - config->max_m;
    const sp_real below = config->min_m - x;
    const sp_real beyond = above > below ? above : below;
    if (!(beyond > (sp_real)0)) {
        return force_n;
    }
    const sp_real fraction = (sp_real)1 - beyond * fade_per_m;
    return fraction > (sp_real)0 ? force_n * fraction : (sp_real)0;
}

#endif
