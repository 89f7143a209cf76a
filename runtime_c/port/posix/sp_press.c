/* Press of an object with a device whose motor also measures the force. */
#include "sp_press.h"

#include <math.h>

#include "sp_press_watch.h"

static double next_command(sp_press *press)
{
    return press->at < press->n ? press->command_n[press->at++] : 0.0;
}

/* Limit and send the motor's force, N, remembering it for the observer; after a fault brake or
 * let go instead. */
static int apply_motor_force(sp_press *press, double motor_n, double *force_n)
{
    const double limited_n = fmin(fmax(motor_n, -press->max_force_n), press->max_force_n);
    press->motor_n[press->tick % SP_PRESS_HISTORY] = limited_n;
    press->past_n[press->tick % SP_PRESS_HISTORY] = press->tool_n;
    press->tick++;
    press->latched = press->latched || !isfinite(motor_n) || press->fault != SP_PRESS_NO_FAULT;
    *force_n = press->latched ? brake_n(press) : -limited_n;
    return press->latched ? press->latched_note : 0;
}

/* Observer, first half: move the estimated tool by a tick under the motor's force and the
 * estimated resistance. */
static void predict(sp_press *press)
{
    const double motor_n =
        press->motor_n[(press->tick - 1u - press->motor_late) % SP_PRESS_HISTORY];
    const double push_n = press->seen ? motor_n - press->tool_n : 0.0;
    const double change_mps = press->dt_s * push_n / press->mass_kg;
    press->tool_m += press->dt_s * (press->tool_mps + 0.5 * change_mps);
    press->tool_mps += change_mps;
}

/* Observer, second half: correct position, speed and resistance of the estimated tool by the
 * measured position, with three equal poles. */
static void correct(sp_press *press, double position_m)
{
    const double pole = press->pole;
    const double rest = 1.0 - pole;
    const double off_m = press->seen ? position_m - press->tool_m : 0.0;
    const double off_mps = off_m / press->dt_s;
    press->tool_m = press->seen ? press->tool_m + (1.0 - pole * pole * pole) * off_m : position_m;
    press->tool_mps += 1.5 * rest * rest * (1.0 + pole) * off_mps;
    press->tool_n -= rest * rest * rest * press->mass_kg * off_mps / press->dt_s;
    press->seen = 1;
}

/* Learn the device's own friction: what the observer says the motor works against, less the
 * force that the sensor measures at the object, slowly. */
static void update_resistance(sp_press *press)
{
    const double past_n =
        press->sensor_late == 0u
            ? press->tool_n
            : press->past_n[(press->tick - press->sensor_late) % SP_PRESS_HISTORY];
    const double new_n =
        isfinite(press->measured_n) ? past_n - press->measured_n - press->resistance_n : 0.0;
    const double max_n = 0.5 * press->max_force_n;
    press->resistance_n =
        fmin(fmax(press->resistance_n + press->resistance_share * new_n, -max_n), max_n);
}

static double observer_force_n(const sp_press *press)
{
    return press->resistance_n - press->damping_nspm * press->tool_mps;
}

/* Force added to the command where no mass is known, N: P and filtered D of the measured
 * force's error. */
static double feedback_n(sp_press *press, double command_n)
{
    double part_n = 0.0;
    if (isfinite(press->measured_n)) {
        const double error_n = command_n - press->measured_n;
        const double change_n =
            (error_n - press->error_n) * (press->dt_s / (press->dt_s + press->d_time_s));
        press->error_n += change_n;
        part_n = press->p_gain * error_n + press->d_gain_s * change_n / press->dt_s;
    }
    return part_n;
}

/* A tick with a sample: the motor's force that makes the object feel the next commanded force. */
static int follow_command(sp_press *press, double position_m, double *force_n)
{
    const double command_n = next_command(press);
    double motor_n = command_n;
    press->silent_s = 0.0;
    watch(press, position_m);
    if (press->mass_kg > 0.0) {
        predict(press);
        correct(press, position_m);
        update_resistance(press);
        motor_n += observer_force_n(press);
    } else {
        motor_n += feedback_n(press, command_n);
    }
    return apply_motor_force(press, motor_n, force_n);
}

/* A tick without a sample: go on with the command and the prediction until the watchdog's time
 * is over. */
static int wait_for_sample(sp_press *press, double dt_s, double *force_n)
{
    double motor_n = next_command(press);
    press->silent_s += dt_s;
    press->latched = press->latched || press->silent_s > press->watchdog_s;
    if (press->mass_kg > 0.0) {
        predict(press);
        motor_n += observer_force_n(press);
    }
    return apply_motor_force(press, motor_n, force_n);
}

/* A position that is no number is no sample. */
int sp_press_step(sp_press *press, double position_m, double velocity_mps, double *force_n)
{
    (void)velocity_mps; /* of a device's own filter: late */
    return isfinite(position_m) ? follow_command(press, position_m, force_n)
                                : wait_for_sample(press, press->dt_s, force_n);
}

int sp_press_idle(sp_press *press, double dt_s, double *force_n)
{
    return wait_for_sample(press, dt_s, force_n);
}

/* Begin anew: no force, no estimate, no fault. */
void sp_press_reset(sp_press *press)
{
    press->error_n = 0.0;
    press->tool_mps = 0.0;
    press->tool_n = 0.0;
    press->resistance_n = 0.0;
    press->silent_s = 0.0;
    press->seen = 0;
    press->latched = 0;
    reset_faults(press);
}
