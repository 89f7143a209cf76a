/* Trained range: the model never sees a depth that it was not trained on. */
#ifndef SP_RANGE_H
#define SP_RANGE_H

#include "sp_notes.h"
#include "sp_real.h"

typedef struct {
    sp_real least_m;
    sp_real greatest_m;
} sp_range_config;

static inline sp_real sp_range_clip(const sp_range_config *config, sp_real x, int *notes)
{
    if (x > config->greatest_m) {
        *notes |= SP_NOTE_OUTSIDE;
        return config->greatest_m;
    }
    if (x < config->least_m) {
        *notes |= SP_NOTE_OUTSIDE;
        return config->least_m;
    }
    return x;
}

#endif
