/* The same history told in two ways: sp_step_dt over the time between samples, and sp_idle for
 * every tick without one before sp_step. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "sp_notes.h"
#include "sp_real.h"

typedef int (*step_function)(void *, sp_real, sp_real, sp_real *);
typedef int (*step_dt_function)(void *, sp_real, sp_real, sp_real, sp_real *);
typedef int (*idle_function)(void *, sp_real, sp_real *);
typedef void (*reset_function)(void *);

typedef struct {
    void *step, *step_dt, *idle, *reset;
    void *by_time, *by_ticks; /* two states */
    double dt_s, low_m, high_m, max_mps;
} histories_scene;

typedef struct {
    double max_difference_n;
    double peak_n;
    uint64_t samples, latched, latched_otherwise;
} histories_found;

void histories(const histories_scene *scene, uint32_t n, uint64_t seed, histories_found *found);

static double random_share(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (double)(*state * 2685821657736338717u >> 11) * 0x1p-53;
}

/* Ticks up to the next sample: mostly one, some losses, now and then longer than the watchdog. */
static uint32_t until_next(uint64_t *random)
{
    const double what = random_share(random);
    if (what < 0.7) {
        return 1;
    }
    return 1 + (uint32_t)(random_share(random) * (what < 0.98 ? 20.0 : 60.0));
}

/* Each history: `SAMPLES` samples of a sine between two depths, of a random speed and phase. */
void histories(const histories_scene *scene, uint32_t n, uint64_t seed, histories_found *found)
{
    enum { SAMPLES = 12 };
    step_function step;
    step_dt_function step_dt;
    idle_function idle;
    reset_function reset;
    memcpy(&step, &scene->step, sizeof step);
    memcpy(&step_dt, &scene->step_dt, sizeof step_dt);
    memcpy(&idle, &scene->idle, sizeof idle);
    memcpy(&reset, &scene->reset, sizeof reset);
    uint64_t random = seed * 2 + 1;
    for (uint32_t h = 0; h < n; h++) {
        const double half_m = 0.5 * (scene->high_m - scene->low_m);
        const double per_tick = random_share(&random) * scene->max_mps * scene->dt_s / half_m;
        double phase = 6.283185307179586 * random_share(&random);
        reset(scene->by_time);
        reset(scene->by_ticks);
        for (int i = 0; i < 60 + SAMPLES; i++) {
            const uint32_t ticks = i < 60 ? 1 : until_next(&random);
            phase += per_tick * ticks;
            const sp_real x = (sp_real)(scene->low_m + half_m * (1.0 - cos(phase)));
            sp_real time_n = 0, ticks_n = 0;
            for (uint32_t k = 1; k < ticks; k++) {
                (void)idle(scene->by_ticks, (sp_real)scene->dt_s, &ticks_n);
            }
            const int seen = step(scene->by_ticks, x, (sp_real)0, &ticks_n);
            const int seen_dt =
                step_dt(scene->by_time, (sp_real)(ticks * scene->dt_s), x, (sp_real)0, &time_n);
            const double off_n = fabs((double)time_n - (double)ticks_n);
            found->max_difference_n = fmax(found->max_difference_n, off_n);
            found->peak_n = fmax(found->peak_n, fabs((double)ticks_n));
            found->samples++;
            found->latched += seen & SP_NOTE_LATCHED ? 1 : 0;
            found->latched_otherwise += (seen ^ seen_dt) & SP_NOTE_LATCHED ? 1 : 0;
        }
    }
}
