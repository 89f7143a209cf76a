/* A hand that holds a device in closed loop with a scene: an own integration, beside sim/. */
#ifndef HELD_DEVICE_H
#define HELD_DEVICE_H

#include <stdint.h>

#include "sp_real.h"

/* springpot declarations begin */
typedef struct {
    /* Exact step of a tick, from position (m), velocity (m/s) and the held force (N). */
    double position[3];
    double velocity[3];
    double step_m, noise_m;
    uint32_t delay_ticks; /* at most 15 */
    uint32_t seed;
} held_device;

/* Press to the end of pressed_m, then hold there. `step` is the scene's sp_step. nudge_n:
 * (n_hold,), beside the hand's own force. Writes the tool's velocity of each tick of the hold. */
void held_device_run(const held_device *device, void *step, void *state, uint32_t n_press,
                     const double *pressed_m, uint32_t n_hold, const double *nudge_n,
                     double *velocity_mps);
/* springpot declarations end */

#endif
