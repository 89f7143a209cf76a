#include "sp_excite.h"

#include <math.h>

static const double soft_share = 0.6; /* of the travel; beyond it a stiffer spring */

static void begin(sp_excite *excite, double position_m)
{
    excite->start_m = position_m;
    excite->before_m = position_m;
    excite->low_m = position_m;
    excite->high_m = position_m;
    excite->pulse_m = position_m;
    excite->begun = 1;
}

static void end(sp_excite *excite, double position_m)
{
    excite->latched = 1;
    excite->beyond = 1;
    excite->beyond_m = position_m - excite->start_m;
}

static void watch_pulses(sp_excite *excite, double position_m)
{
    if (excite->at < excite->quiet_ticks) {
        excite->low_m = fmin(excite->low_m, position_m);
        excite->high_m = fmax(excite->high_m, position_m);
        excite->pulse_m = position_m;
        return;
    }
    const uint32_t into = (excite->at - excite->quiet_ticks) % excite->pulse_ticks;
    if (into == 0u) {
        excite->pulse_m = position_m;
    }
    const double moved_m = position_m - excite->pulse_m;
    const double min_moved_m = fmax(excite->seen_m, 3.0 * (excite->high_m - excite->low_m));
    if (!excite->seen && fabs(moved_m) > min_moved_m) {
        const uint32_t end_at = excite->at - into + 2u * excite->pulse_ticks;
        excite->seen = 1;
        excite->n = end_at < excite->n ? end_at : excite->n;
    }
}

/* After each half swing of the command: wider, or less wide. */
static void adapt_gain(sp_excite *excite)
{
    const double min_factor = 0.4; /* after a swing that was too large */
    if (excite->at == 0u || excite->at >= excite->n ||
        (excite->command[excite->at] > 0.0) == (excite->command[excite->at - 1u] > 0.0)) {
        return;
    }
    if (excite->half_m > excite->swing_m) {
        excite->gain_n *= fmax(excite->swing_m / excite->half_m, min_factor);
    } else {
        excite->gain_n = fmin(excite->gain_n + excite->gain_step_n, excite->max_force_n);
    }
    excite->half_m = 0.0;
}

/* A spring and a damper, weak within the soft part of the travel. */
static double centring(const sp_excite *excite, double offset_m)
{
    const double soft_m = soft_share * excite->max_travel_m;
    const double beyond_m = fmax(fabs(offset_m) - soft_m, 0.0);
    const double wall_n = beyond_m * excite->max_force_n / (excite->max_travel_m - soft_m);
    return excite->sign * (excite->stiffness_npm * offset_m + copysign(wall_n, offset_m) +
                           excite->damping_nspm * excite->velocity_mps);
}

/* The velocity, of differences of positions. */
static void follow(sp_excite *excite, double position_m)
{
    const double time_s = 0.003; /* of the low-pass */
    const double passed_s = excite->dt_s + excite->silent_s;
    const double difference_mps = (position_m - excite->before_m) / passed_s;
    excite->velocity_mps +=
        (difference_mps - excite->velocity_mps) * (passed_s / (passed_s + time_s));
    excite->before_m = position_m;
    excite->silent_s = 0.0;
}

/* What is played in this tick; in the hard part of the travel nothing that pushes outwards. */
static double play(sp_excite *excite, double offset_m)
{
    double played_n = 0.0;
    if (excite->at < excite->n) {
        played_n = excite->gain_n * excite->command[excite->at];
        excite->at++;
    }
    if (-excite->sign * played_n * offset_m > 0.0 &&
        fabs(offset_m) > soft_share * excite->max_travel_m) {
        played_n = 0.0;
    }
    return played_n;
}

int sp_excite_step(sp_excite *excite, double position_m, double velocity_mps, double *force_n)
{
    (void)velocity_mps; /* not every device has one */
    *force_n = 0.0;
    if (!excite->begun) {
        begin(excite, position_m);
    }
    const double offset_m = position_m - excite->start_m;
    if (!excite->latched && !(fabs(offset_m) <= excite->max_travel_m)) {
        end(excite, position_m);
    }
    if (excite->latched) {
        return excite->latched_note;
    }
    follow(excite, position_m);
    if (excite->pulse_ticks > 0u) {
        watch_pulses(excite, position_m);
    }
    if (excite->swing_m > 0.0) {
        excite->half_m = fmax(excite->half_m, fabs(offset_m));
        adapt_gain(excite);
    }
    const double wanted_n = play(excite, offset_m) + centring(excite, offset_m);
    *force_n = fmin(fmax(wanted_n, -excite->max_force_n), excite->max_force_n);
    return 0;
}

/* Without a sample the last force would go on blindly: none until the next. */
int sp_excite_idle(sp_excite *excite, double dt_s, double *force_n)
{
    *force_n = 0.0;
    excite->silent_s += dt_s;
    if (excite->silent_s > excite->watchdog_s) {
        excite->latched = 1;
    }
    if (excite->at < excite->n) {
        excite->at++;
    }
    return excite->latched ? excite->latched_note : 0;
}

void sp_excite_reset(sp_excite *excite)
{
    excite->silent_s = 0.0;
}
