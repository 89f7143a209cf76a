#include "sp_slide.h"

#include <string.h>

typedef int (*step3_function)(void *, const sp_real *, const sp_real *, sp_real *);
typedef int (*idle3_function)(void *, sp_real, sp_real *);
typedef void (*scene_reset)(void *);

static int leave(sp_slide *self, int notes, const sp_real *given_n, sp_real *force_n)
{
    if (notes >= 0) {
        self->lateral_n[0] = (double)given_n[0];
        self->lateral_n[1] = (double)given_n[1];
        *force_n = given_n[2];
    }
    return notes;
}

int sp_slide_step(void *slide, sp_real position_m, sp_real velocity_mps, sp_real *force_n)
{
    sp_slide *self = slide;
    const sp_real at[3] = {(sp_real)self->lateral_m[0], (sp_real)self->lateral_m[1], position_m};
    sp_real given_n[3] = {0};
    step3_function step3;
    (void)velocity_mps;
    memcpy(&step3, &self->step3, sizeof step3);
    const int notes = step3(self->state, at, NULL, given_n);
    return leave(self, notes, given_n, force_n);
}

int sp_slide_idle(void *slide, sp_real dt_s, sp_real *force_n)
{
    sp_slide *self = slide;
    sp_real given_n[3] = {0};
    idle3_function idle3;
    memcpy(&idle3, &self->idle3, sizeof idle3);
    const int notes = idle3(self->state, dt_s, given_n);
    return leave(self, notes, given_n, force_n);
}

void sp_slide_reset(void *slide)
{
    sp_slide *self = slide;
    scene_reset reset;
    memcpy(&reset, &self->reset, sizeof reset);
    reset(self->state);
    self->lateral_n[0] = 0.0;
    self->lateral_n[1] = 0.0;
}
