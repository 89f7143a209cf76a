/* Simulated haptic device: mass, motor, encoder, load cell. */
#include "sim_device.h"

#include <math.h>
#include <stddef.h>

static const double control_dt_s = 0.001;
static const double force_noise_n = 0.015;
static const double position_noise_m = 3e-6;
static const double motor_limit_n = 20.0;

/* Force control: the command, plus P and filtered D of the load cell's error. */
static const double p_gain = 5.0;      /* N/N */
static const double d_gain_s = 0.03;   /* N/(N/s) */
static const double d_time_s = 0.0015; /* of the D part's low-pass */

double sim_device_encoder_m(sim_noise *noise, double position_m, double noise_m, double step_m)
{
    return step_m * floor((position_m + noise_m * sim_noise_normal(noise)) / step_m + 0.5);
}

uint32_t sim_bench_size(void)
{
    return (uint32_t)sizeof(sim_bench);
}

/* A bench that presses an object by a motor under force control; delay_samples: 0 or 1. */
int sim_bench_init(sim_bench *bench, uint32_t object, uint32_t variant, double stiffer,
                   uint64_t seed, uint32_t delay_samples, uint32_t substeps)
{
    if (bench == NULL) {
        return SIM_NULL;
    }
    if (delay_samples > 1) {
        return SIM_RANGE;
    }
    int status = sim_object_init(&bench->object, object, variant, stiffer, control_dt_s, substeps);
    if (status != SIM_OK) {
        return status;
    }
    sim_noise_init(&bench->noise, seed);
    bench->delay_samples = delay_samples;
    bench->position_m = 0.0;
    bench->velocity_mps = 0.0;
    bench->motor_n = 0.0;
    bench->late_motor_n = 0.0;
    bench->error_n = 0.0;
    return SIM_OK;
}

int sim_bench_place(sim_bench *bench, double x_m, double y_m)
{
    return bench == NULL ? SIM_NULL : sim_object_place(&bench->object, x_m, y_m);
}

/* One step of the bench's force control: P and filtered D of the measured error, limited, a
 * sample late if it is so set. */
static void control(sim_bench *bench, double command_n, double measured_n)
{
    double error_n = command_n - measured_n;
    double change_n = (error_n - bench->error_n) * (control_dt_s / (control_dt_s + d_time_s));
    bench->error_n += change_n;
    double wanted_n = command_n + p_gain * error_n + d_gain_s * change_n / control_dt_s;
    double motor_n = fmin(fmax(wanted_n, -motor_limit_n), motor_limit_n);
    bench->motor_n = bench->delay_samples == 1 ? bench->late_motor_n : motor_n;
    bench->late_motor_n = motor_n;
}

static void kick(sim_bench *bench, double step_s)
{
    double push_n = bench->motor_n - bench->object.force_n;
    double braked_n = push_n - SIM_DEVICE_DAMPING_NSPM * bench->velocity_mps;
    bench->velocity_mps += step_s * braked_n / SIM_DEVICE_MASS_KG;
}

/* Advance motor and object by a control step. Half a kick, drift, half a kick (leapfrog): the
 * integrator neither damps a stiff object nor feeds it. */
static void move(sim_bench *bench)
{
    double step_s = bench->object.step_s;
    for (uint32_t i = 0; i < bench->object.substeps; i++) {
        kick(bench, 0.5 * step_s);
        bench->position_m += step_s * bench->velocity_mps;
        sim_object_substep(&bench->object, bench->position_m);
        kick(bench, 0.5 * step_s);
    }
}

/* Record n samples of position and force, with their sensors' noise, while the bench follows
 * command_n. */
int sim_bench_record(sim_bench *bench, uint32_t n, const double *command_n, double *position_m,
                     double *force_n)
{
    if (bench == NULL || command_n == NULL || position_m == NULL || force_n == NULL) {
        return SIM_NULL;
    }
    if (!sim_all_finite(n, command_n)) {
        return SIM_RANGE;
    }
    for (uint32_t i = 0; i < n; i++) {
        position_m[i] = sim_device_encoder_m(&bench->noise, bench->position_m, position_noise_m,
                                             SIM_ENCODER_STEP_M);
        force_n[i] = bench->object.force_n + force_noise_n * sim_noise_normal(&bench->noise);
        control(bench, command_n[i], force_n[i]);
        move(bench);
    }
    return SIM_OK;
}
