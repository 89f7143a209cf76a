/* A scene of three axes behind the calls of one: the loop sees the depth and the force along it;
 * x and y pass beside them. Built once for each number type. */
#ifndef SP_SLIDE_H
#define SP_SLIDE_H

#include "sp_real.h"

/* springpot declarations begin */
typedef struct {
    void *step3;         /* int (void *state, const sp_real at[3], const sp_real *, sp_real n[3]) */
    void *idle3;         /* int (void *state, sp_real dt_s, sp_real n[3]) */
    void *reset;         /* void (void *state) */
    void *state;         /* of the scene */
    double lateral_m[2]; /* x and y of the tool: set before each step */
    double lateral_n[2]; /* force on the tool along them: of the last call */
} sp_slide;

/* What a loop calls with a sp_slide as its state. */
int sp_slide_step(void *slide, sp_real position_m, sp_real velocity_mps, sp_real *force_n);
int sp_slide_idle(void *slide, sp_real dt_s, sp_real *force_n);
void sp_slide_reset(void *slide);
/* springpot declarations end */

#endif
