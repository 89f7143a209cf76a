#include "sp_press.h"

#include <math.h>

static double next_command(sp_press *press)
{
    return press->at < press->n ? press->command_n[press->at++] : 0.0;
}

static int push(const sp_press *press, double motor_n, double *force_n)
{
    const double limited_n = fmin(fmax(motor_n, -press->max_force_n), press->max_force_n);
    *force_n = press->latched ? 0.0 : -limited_n;
    return press->latched ? press->latched_note : 0;
}

int sp_press_step(sp_press *press, double position_m, double velocity_mps, double *force_n)
{
    const double command_n = next_command(press);
    double motor_n = command_n;
    (void)position_m;
    (void)velocity_mps;
    press->silent_s = 0.0;
    if (isfinite(press->measured_n)) {
        const double error_n = command_n - press->measured_n;
        const double change_n =
            (error_n - press->error_n) * (press->dt_s / (press->dt_s + press->d_time_s));
        press->error_n += change_n;
        const double max_n = 0.5 * press->max_force_n;
        press->integral_n = fmin(
            fmax(press->integral_n + press->i_gain_per_s * press->dt_s * error_n, -max_n), max_n);
        motor_n += press->p_gain * error_n + press->d_gain_s * change_n / press->dt_s;
        motor_n += press->integral_n;
    }
    return push(press, motor_n, force_n);
}

/* Time goes on without a sample: the command does too, for a while. */
int sp_press_idle(sp_press *press, double dt_s, double *force_n)
{
    press->silent_s += dt_s;
    press->latched = press->latched || press->silent_s > press->watchdog_s;
    return push(press, next_command(press), force_n);
}

void sp_press_reset(sp_press *press)
{
    press->error_n = 0.0;
    press->integral_n = 0.0;
    press->silent_s = 0.0;
    press->latched = 0;
}
