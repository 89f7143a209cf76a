#include "pressed_tool.h"

#include <math.h>
#include <stddef.h>

#include "sim_noise.h"

enum { SUBSTEPS = 8, PAST = 512 };
static const double tick_s = 1e-3, encoder_noise_m = 3e-6;

static double read_position(sim_noise *noise, double position_m, double step_m)
{
    const double noisy_m = position_m + encoder_noise_m * sim_noise_normal(noise);
    return step_m * floor(noisy_m / step_m + 0.5);
}

/* A spring can push, and no more. */
static double object_n(const pressed_tool *is, sim_object *object, double depth_m, double speed_mps)
{
    double force_n = 0.0;
    if (object == NULL) {
        force_n = fmax(0.0, is->table_npm * (depth_m - is->table_m));
    } else if (is->spring_npm == 0.0) {
        (void)sim_object_move(object, 1, &depth_m, &force_n);
    } else if (depth_m > 0.0) {
        force_n = fmax(0.0, is->spring_npm * depth_m + is->damper_nspm * speed_mps);
    }
    return force_n;
}

/* What the sensor shows for a force: perhaps not all of it. */
static double shown_n(const pressed_tool *is, const sp_press *press, uint32_t tick, double felt_n)
{
    if (is->wrong_tick == 0u || tick < is->wrong_tick) {
        return felt_n;
    }
    return is->sensor_holds ? press->measured_n : is->sensor_gain * felt_n;
}

/* From rest only what exceeds friction moves it; friction brakes to rest and no further. */
static double next_speed(const pressed_tool *is, double push_n, double speed_mps, double step_s)
{
    const double way = speed_mps != 0.0 ? speed_mps : push_n;
    if (speed_mps == 0.0 && fabs(push_n) <= is->coulomb_n) {
        return 0.0;
    }
    const double next_mps =
        speed_mps + step_s * (push_n - copysign(is->coulomb_n, way)) / is->mass_kg;
    return is->coulomb_n > 0.0 && next_mps * speed_mps < 0.0 ? 0.0 : next_mps;
}

int pressed_tool_run(const pressed_tool *is, sp_press *press, uint32_t n, double *position_m,
                     double *force_n, double *motor_n)
{
    static double object_memory[65536];
    sim_object *object = (sim_object *)object_memory;
    const double step_s = tick_s / SUBSTEPS;
    double felt_n[PAST] = {0}, pushed_n[PAST] = {0};
    double at_m = 0.0, speed_mps = 0.0, returned_n;
    sim_noise noise;
    const int status = sim_object_init(object, is->object, 0, 1.0, step_s, 2);
    if (status != SIM_OK) {
        return status;
    }
    sim_noise_init(&noise, 1);
    for (uint32_t at = 0; at < n * SUBSTEPS; at++) {
        const uint32_t tick = at / SUBSTEPS;
        const int lost = is->lost_tick != 0u && tick >= is->lost_tick;
        const double now_n = object_n(is, lost ? NULL : object, at_m - is->gap_m, speed_mps);
        felt_n[at % PAST] = now_n;
        if (at % SUBSTEPS == 0) {
            const double seen_m = read_position(&noise, at_m, is->encoder_m);
            press->measured_n = shown_n(is, press, tick, felt_n[(at - is->sensor_late) % PAST]);
            press->measured_n += is->noise_n * sim_noise_normal(&noise);
            (void)sp_press_step(press, seen_m, 0.0, &returned_n);
            position_m[tick] = at_m;
            force_n[tick] = now_n;
            motor_n[tick] = -returned_n;
        }
        pushed_n[at % PAST] = -returned_n;
        const double push_n =
            pushed_n[(at - is->motor_late) % PAST] - now_n - is->viscous_nspm * speed_mps;
        speed_mps = next_speed(is, push_n, speed_mps, step_s);
        at_m += step_s * speed_mps;
    }
    return SIM_OK;
}
