#include "sim_free.h"

#include <math.h>
#include <stddef.h>

#include "sim.h"
#include "sim_noise.h"

enum { QUEUE = 128, MAX_DELAY_TICKS = 100, SUBSTEPS = 32 };

static const double stribeck_mps = 0.01;
static const double bristle_damping = 0.3; /* of a bristle and the mass, relative to critical */
static const double two_pi = 6.283185307179586;

struct sim_free {
    sim_free_settings is;
    sim_noise noise;
    double dt_s;
    uint32_t whole_ticks; /* of the delay */
    double part_s;        /* and what is left of it */
    double queue_n[QUEUE];
    uint32_t ticks;
    double position_m;
    double velocity_mps;
    double bent_m; /* bristles */
    double read_m; /* last reading */
};

uint32_t sim_free_size(void)
{
    return (uint32_t)sizeof(sim_free);
}

static double read_position(sim_free *device)
{
    const double step_m = device->is.position_step_m;
    const double noisy_m =
        device->position_m + device->is.position_noise_m * sim_noise_normal(&device->noise);
    return step_m > 0.0 ? step_m * floor(noisy_m / step_m + 0.5) : noisy_m;
}

int sim_free_init(sim_free *device, const sim_free_settings *settings, double dt_s)
{
    if (device == NULL || settings == NULL) {
        return SIM_NULL;
    }
    if (!(dt_s > 0.0 && isfinite(dt_s)) || !(settings->mass_kg > 0.0) ||
        !(settings->delay_s >= 0.0 && settings->delay_s <= MAX_DELAY_TICKS * dt_s) ||
        (settings->cogging_n > 0.0 && !(settings->cogging_pitch_m > 0.0))) {
        return SIM_RANGE;
    }
    *device = (sim_free){.is = *settings, .dt_s = dt_s};
    device->whole_ticks = (uint32_t)(settings->delay_s / dt_s);
    device->part_s = settings->delay_s - device->whole_ticks * dt_s;
    sim_noise_init(&device->noise, settings->seed);
    device->read_m = read_position(device);
    return SIM_OK;
}

/* Without friction, N, positive into the object. */
static double drive(const sim_free *device, double motor_n)
{
    const sim_free_settings *is = &device->is;
    double drive_n = -motor_n - is->bias_n;
    if (is->cogging_n > 0.0) {
        drive_n += is->cogging_n * sin(two_pi * device->position_m / is->cogging_pitch_m);
    }
    return drive_n;
}

/* Half a kick, drift, half a kick in one direction; what is left of the time once it came to rest.
 */
static double slide_one_way(sim_free *device, double drive_n, double way, double step_s)
{
    const sim_free_settings *is = &device->is;
    const double push_n = drive_n - way * is->coulomb_n;
    const double half_s = 0.5 * step_s / is->mass_kg;
    const double begin_mps = device->velocity_mps;
    const double middle_mps = begin_mps + half_s * (push_n - is->viscous_nspm * begin_mps);
    const double end_mps = (middle_mps + half_s * push_n) / (1.0 + half_s * is->viscous_nspm);
    if (way * end_mps > 0.0) {
        device->position_m += step_s * middle_mps;
        device->velocity_mps = end_mps;
        return 0.0;
    }
    const double rest_s = step_s * begin_mps / (begin_mps - end_mps);
    device->position_m += 0.5 * rest_s * begin_mps;
    device->velocity_mps = 0.0;
    return step_s - rest_s;
}

/* From rest only what exceeds friction moves it. */
static void slide(sim_free *device, double motor_n, double step_s)
{
    const double drive_n = drive(device, motor_n);
    double left_s = step_s;
    if (device->velocity_mps != 0.0) {
        left_s = slide_one_way(device, drive_n, copysign(1.0, device->velocity_mps), step_s);
    }
    if (left_s > 0.0 && fabs(drive_n) > device->is.coulomb_n) {
        (void)slide_one_way(device, drive_n, copysign(1.0, drive_n), left_s);
    }
}

/* Canudas de Wit and others 1995: bristles that bend, and more friction at rest. */
static void slide_on_bristles(sim_free *device, double motor_n, double step_s)
{
    const sim_free_settings *is = &device->is;
    const double stiffness_npm = is->coulomb_n / is->bristle_m;
    const double damping_nspm = 2.0 * bristle_damping * sqrt(stiffness_npm * is->mass_kg);
    const double speed_mps = fabs(device->velocity_mps);
    const double ratio = speed_mps / stribeck_mps;
    const double max_bent_m =
        is->bristle_m * (1.0 + (is->static_ratio - 1.0) * exp(-ratio * ratio));
    const double before_m = device->bent_m;
    if (speed_mps > 0.0) {
        const double end_m = device->velocity_mps > 0.0 ? max_bent_m : -max_bent_m;
        device->bent_m = end_m + (before_m - end_m) * exp(-step_s * speed_mps / max_bent_m);
    }
    const double friction_n = stiffness_npm * device->bent_m +
                              damping_nspm * (device->bent_m - before_m) / step_s +
                              is->viscous_nspm * device->velocity_mps;
    device->velocity_mps += step_s * (drive(device, motor_n) - friction_n) / is->mass_kg;
    device->position_m += step_s * device->velocity_mps;
}

/* The force that was commanded so many ticks ago acts for this while. */
static void move(sim_free *device, uint32_t ticks_ago, double while_s)
{
    const uint32_t at = device->ticks - ticks_ago;
    const double motor_n = device->ticks < ticks_ago ? 0.0 : device->queue_n[at % QUEUE];
    for (int i = 0; i < SUBSTEPS; i++) {
        if (device->is.bristle_m > 0.0) {
            slide_on_bristles(device, motor_n, while_s / SUBSTEPS);
        } else {
            slide(device, motor_n, while_s / SUBSTEPS);
        }
    }
}

int sim_free_step(sim_free *device, double command_n, double *position_m, double *velocity_mps)
{
    if (device == NULL || position_m == NULL || velocity_mps == NULL) {
        return SIM_NULL;
    }
    if (!isfinite(command_n)) {
        return SIM_RANGE;
    }
    const double max_n = device->is.max_n;
    const double limited_n = fmin(fmax(command_n, -max_n), max_n);
    device->queue_n[device->ticks % QUEUE] = device->is.sign * limited_n;
    if (device->part_s > 0.0) {
        move(device, device->whole_ticks + 1, device->part_s);
    }
    move(device, device->whole_ticks, device->dt_s - device->part_s);
    device->ticks++;
    *position_m = read_position(device);
    *velocity_mps = (*position_m - device->read_m) / device->dt_s;
    device->read_m = *position_m;
    if (device->is.velocity_noise_mps >= 0.0) {
        *velocity_mps =
            device->velocity_mps + device->is.velocity_noise_mps * sim_noise_normal(&device->noise);
    }
    return SIM_OK;
}

void sim_free_truth(const sim_free *device, double *position_m, double *velocity_mps)
{
    *position_m = device->position_m;
    *velocity_mps = device->velocity_mps;
}
