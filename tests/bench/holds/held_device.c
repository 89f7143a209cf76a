#include "held_device.h"

#include <math.h>

enum { MAX_DELAY = 16 };

typedef int (*step_function)(void *state, sp_real position_m, sp_real velocity_mps,
                             sp_real *force_n);

/* Numbers of xorshift32, (0, 1]. */
static double uniform(uint32_t *seed)
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 17;
    *seed ^= *seed << 5;
    return ((double)*seed + 1.0) / 4294967296.0;
}

/* What the encoder reads: noise by Box and Muller, then whole steps. */
static double read_encoder(const held_device *device, uint32_t *seed, double position_m)
{
    const double radius = sqrt(-2.0 * log(uniform(seed)));
    const double noise_m = device->noise_m * radius * cos(6.283185307179586 * uniform(seed));
    return device->step_m * floor((position_m + noise_m) / device->step_m + 0.5);
}

void held_device_run(const held_device *device, void *step, void *state, uint32_t n_press,
                     const double *pressed_m, uint32_t n_hold, const double *nudge_n,
                     double *velocity_mps)
{
    const step_function scene = (step_function)(uintptr_t)step;
    double late_n[MAX_DELAY] = {0};
    uint32_t seed = device->seed * 2654435761u + 1u;
    sp_real force_n = 0;
    for (uint32_t i = 0; i < n_press; i++) {
        (void)scene(state, (sp_real)read_encoder(device, &seed, pressed_m[i]), 0, &force_n);
        late_n[i % MAX_DELAY] = (double)force_n;
    }
    /* The hand bears what the object gives now. */
    const double held_n = (double)force_n;
    double moved_m = 0.0, speed_mps = 0.0;
    for (uint32_t i = 0; i < n_hold; i++) {
        const double at_m = pressed_m[n_press - 1] + moved_m;
        (void)scene(state, (sp_real)read_encoder(device, &seed, at_m), 0, &force_n);
        late_n[(n_press + i) % MAX_DELAY] = (double)force_n;
        const double acts_n = late_n[(n_press + i + MAX_DELAY - device->delay_ticks) % MAX_DELAY];
        const double push_n = held_n + nudge_n[i] - acts_n;
        const double next_m = device->position[0] * moved_m + device->position[1] * speed_mps +
                              device->position[2] * push_n;
        speed_mps = device->velocity[0] * moved_m + device->velocity[1] * speed_mps +
                    device->velocity[2] * push_n;
        moved_m = next_m;
        velocity_mps[i] = speed_mps;
    }
}
