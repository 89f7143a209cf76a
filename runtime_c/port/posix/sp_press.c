#include "sp_press.h"

#include <math.h>

int sp_press_step(sp_press *press, double position_m, double velocity_mps, double *force_n)
{
    const double command_n = press->at < press->n ? press->command_n[press->at++] : 0.0;
    double motor_n = command_n;
    (void)position_m;
    (void)velocity_mps;
    if (isfinite(press->measured_n)) {
        const double error_n = command_n - press->measured_n;
        const double change_n =
            (error_n - press->error_n) * (press->dt_s / (press->dt_s + press->d_time_s));
        press->error_n += change_n;
        motor_n += press->p_gain * error_n + press->d_gain_s * change_n / press->dt_s;
    }
    *force_n = -fmin(fmax(motor_n, -press->max_force_n), press->max_force_n);
    return 0;
}

/* Time goes on without a sample: the command does too. */
int sp_press_idle(sp_press *press, double dt_s, double *force_n)
{
    const double command_n = press->at < press->n ? press->command_n[press->at++] : 0.0;
    (void)dt_s;
    *force_n = -fmin(fmax(command_n, -press->max_force_n), press->max_force_n);
    return 0;
}

void sp_press_reset(sp_press *press)
{
    press->error_n = 0.0;
}
