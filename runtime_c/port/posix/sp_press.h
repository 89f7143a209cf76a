/* Force control while recording: the tool presses with a commanded force. To the loop it is a
 * scene: the force that it returns drives the motor, so that it is negative while pressing.
 *
 * The motor gets the command, a part of the measured error, and a part of its sum. Without samples
 * for the watchdog's time the press is over: no force, latched. */
#ifndef SP_PRESS_H
#define SP_PRESS_H

#include <stdint.h>

/* springpot declarations begin */
typedef struct {
    const double *command_n; /* one value a tick, positive into the object */
    uint32_t n;
    uint32_t at;
    double dt_s;
    double max_force_n;
    double p_gain;       /* N/N */
    double d_gain_s;     /* N/(N/s) */
    double d_time_s;     /* of the low-pass on the D part */
    double i_gain_per_s; /* N/(N s); the sum is half of max_force_n at most */
    double watchdog_s;
    int32_t latched_note;
    double measured_n;
    double error_n; /* filtered */
    double integral_n;
    double silent_s;
    int32_t latched;
} sp_press;

int sp_press_step(sp_press *press, double position_m, double velocity_mps, double *force_n);
int sp_press_idle(sp_press *press, double dt_s, double *force_n);
void sp_press_reset(sp_press *press);
/* springpot declarations end */

#endif
