#include "sp_switch.h"

#include <math.h>
#include <string.h>
#include <time.h>

typedef int (*step_function)(void *, sp_real, sp_real, sp_real *);
typedef int (*idle_function)(void *, sp_real, sp_real *);
typedef void (*reset_function)(void *);

static uint64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

void sp_switch_want(sp_switch *places, int32_t place)
{
    __atomic_store_n(&places->wanted, place, __ATOMIC_RELEASE);
}

int32_t sp_switch_active(sp_switch *places)
{
    return __atomic_load_n(&places->active, __ATOMIC_ACQUIRE);
}

static void reset_scene(sp_switch *places)
{
    const sp_switch_scene *scene = &places->scenes[places->active];
    if (scene->reset != NULL) {
        reset_function reset;
        memcpy(&reset, &scene->reset, sizeof reset);
        reset(scene->state);
        places->reset = 1;
    }
}

/* Above the surface, and nothing felt: another scene may come. */
static void change_place(sp_switch *places, sp_real position_m)
{
    const int32_t wanted = __atomic_load_n(&places->wanted, __ATOMIC_ACQUIRE);
    const int quiet = position_m <= 0 && fabs(places->force_n) <= places->faded_n;
    if (wanted == places->active || !quiet || wanted < 0 || wanted >= SP_SWITCH_PLACES) {
        return;
    }
    __atomic_store_n(&places->active, wanted, __ATOMIC_RELEASE);
    reset_scene(places);
}

/* The scene's notes with the place, and whether it was reset before this step. */
static int noted(sp_switch *places, int notes, sp_real force_n)
{
    places->force_n = (double)force_n;
    if (notes < 0) {
        return notes;
    }
    const int reset = places->reset ? SP_SWITCH_NOTE_RESET : 0;
    places->reset = 0;
    return notes | (places->active << SP_SWITCH_NOTE_BITS) | reset;
}

int sp_switch_step(sp_switch *places, sp_real position_m, sp_real velocity_mps, sp_real *force_n)
{
    const uint64_t begin_ns = now_ns();
    change_place(places, position_m);
    const sp_switch_scene *scene = &places->scenes[places->active];
    int notes = 0;
    *force_n = 0;
    if (scene->step != NULL) {
        step_function step;
        memcpy(&step, &scene->step, sizeof step);
        notes = step(scene->state, position_m, velocity_mps, force_n);
    }
    uint64_t took_ns = now_ns() - begin_ns;
    places->max_ns = took_ns > places->max_ns ? took_ns : places->max_ns;
    places->overruns += places->latency_ns && took_ns > places->latency_ns;
    while (took_ns < places->latency_ns) {
        took_ns = now_ns() - begin_ns;
    }
    return noted(places, notes, *force_n);
}

int sp_switch_idle(sp_switch *places, sp_real dt_s, sp_real *force_n)
{
    const sp_switch_scene *scene = &places->scenes[places->active];
    int notes = 0;
    *force_n = 0;
    if (scene->idle != NULL) {
        idle_function idle;
        memcpy(&idle, &scene->idle, sizeof idle);
        notes = idle(scene->state, dt_s, force_n);
    }
    return noted(places, notes, *force_n);
}

void sp_switch_reset(sp_switch *places)
{
    places->force_n = 0;
    reset_scene(places);
}
