/* What ends a press: a tool that runs into the object faster than a limit, since it has lost what
 * it pressed; a sensor that does not measure what the motor gives, since it is stuck, wrongly
 * scaled or turned, or touches nothing; a force control that rings. Of sp_press.c alone. */
#ifndef SP_PRESS_WATCH_H
#define SP_PRESS_WATCH_H

#include <math.h>

#include "sp_press.h"

static const double press_mean_s = 0.1;      /* of the forces that are compared */
static const double press_unlike_s = 0.15;   /* for so long they may be unlike: a tool in the air */
static const double press_unlike = 0.5;      /* share of the greater one that may be missing */
static const double press_unlike_max = 0.15; /* and of the greatest: friction, weight */
static const double press_max_brake_s = 0.05;
static const double press_slow = 0.25;         /* of the limit of speed: braked */
static const double press_false = 10.0;        /* of it: no motion, a false position */
static const double press_turn_mps = 0.02;     /* slower motion is no turn */
static const double press_turn_s = 1.0 / 24.0; /* half a cycle above 12 Hz: commands end at 10 */
enum { SP_PRESS_TURNS = 10 };

/* Mean speed over the last positions, m/s; ticks without a position count in the time. */
static inline void measure_speed(sp_press *press, double position_m)
{
    const uint32_t at = press->places % SP_PRESS_SPEED_SAMPLES; /* where the oldest one is */
    const uint32_t ticks = press->tick - press->place_tick[at];
    press->speed_mps = press->places >= SP_PRESS_SPEED_SAMPLES && ticks > 0u
                           ? (position_m - press->place_m[at]) / ((double)ticks * press->dt_s)
                           : 0.0;
    press->place_m[at] = position_m;
    press->place_tick[at] = press->tick;
    press->places++;
}

/* Whether the means of motor force and measured force have differed for too long: a sensor with
 * a wrong sign or scale, or none in contact. */
static inline int has_sensor_mismatch(sp_press *press)
{
    if (press->tick == 0u || !isfinite(press->measured_n)) {
        return 0;
    }
    const double share = press->dt_s / press_mean_s;
    const double motor_n = press->motor_n[(press->tick - 1u) % SP_PRESS_HISTORY];
    press->mean_motor_n += share * (motor_n - press->mean_motor_n);
    press->mean_measured_n += share * (press->measured_n - press->mean_measured_n);
    const double greater_n = fmax(fabs(press->mean_motor_n), fabs(press->mean_measured_n));
    const double most_n = press_unlike * greater_n + press_unlike_max * press->max_force_n;
    const int unlike = fabs(press->mean_motor_n - press->mean_measured_n) > most_n;
    press->unlike_s = unlike ? press->unlike_s + press->dt_s : 0.0;
    return press->unlike_s > press_unlike_s;
}

/* Count the turns of the tool that follow each other faster than any command makes them; returns
 * whether there are so many that the feedback is unstable. Without feedback (no p_gain, and no
 * observer with a mass) fast turns are the object's own, and no fault. */
static inline int is_oscillating(sp_press *press)
{
    const int way = press->speed_mps > press_turn_mps    ? 1
                    : press->speed_mps < -press_turn_mps ? -1
                                                         : press->way;
    if (way != press->way) {
        const double since_s = (double)(press->tick - press->turn_tick) * press->dt_s;
        press->turns = since_s < press_turn_s ? press->turns + 1u : 0u;
        press->turn_tick = press->tick;
        press->way = way;
    }
    return press->turns >= SP_PRESS_TURNS && (press->p_gain != 0.0 || press->mass_kg > 0.0);
}

/* Look for what must end a press: overspeed, a sensor that disagrees, oscillation. */
static inline void watch(sp_press *press, double position_m)
{
    measure_speed(press, position_m);
    if (press->max_mps == 0.0 || press->latched) {
        return;
    }
    const int unlike = has_sensor_mismatch(press);
    const int rings = is_oscillating(press);
    press->fault = press->speed_mps > press->max_mps ? SP_PRESS_OVERSPEED
                   : unlike                          ? SP_PRESS_SENSOR_MISMATCH
                   : rings                           ? SP_PRESS_OSCILLATES
                                                     : SP_PRESS_NO_FAULT;
}

/* After overspeed: the outward force that takes the speed out of a tool that ran away, N, for a
 * short time; else 0. */
static inline double brake_n(sp_press *press)
{
    const double share = press->max_mps > 0.0 ? press->speed_mps / press->max_mps : 0.0;
    const int brakes = press->fault == SP_PRESS_OVERSPEED && press->silent_s == 0.0 &&
                       press->braked_s < press_max_brake_s && share > press_slow &&
                       share < press_false;
    press->braked_s = brakes ? press->braked_s + press->dt_s : press_max_brake_s;
    return brakes ? press->max_force_n * fmin(share, 1.0) : 0.0;
}

/* Forget faults and what led to them. */
static inline void reset_faults(sp_press *press)
{
    press->fault = SP_PRESS_NO_FAULT;
    press->places = 0u;
    press->speed_mps = 0.0;
    press->braked_s = 0.0;
    press->mean_motor_n = 0.0;
    press->mean_measured_n = 0.0;
    press->unlike_s = 0.0;
    press->way = 0;
    press->turns = 0u;
}

#endif
