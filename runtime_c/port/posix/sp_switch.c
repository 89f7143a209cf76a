#include "sp_switch.h"

#include <math.h>
#include <string.h>

#include "sp_loop_self.h"
#include "sp_notes.h"

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
        (void)memcpy(&reset, &scene->reset, sizeof reset);
        reset(scene->state);
        places->reset = 1;
    }
}

/* Above the surface, and nothing felt: another scene may come. */
static void change_place(sp_switch *places, sp_real position_m)
{
    const int32_t wanted = __atomic_load_n(&places->wanted, __ATOMIC_ACQUIRE);
    const int quiet =
        (places->latched == 0) && (position_m <= 0) && (fabs(places->force_n) <= places->faded_n);
    if ((wanted != places->active) && quiet && (wanted >= 0) && (wanted < SP_SWITCH_PLACES)) {
        __atomic_store_n(&places->active, wanted, __ATOMIC_RELEASE);
        reset_scene(places);
    }
}

/* The scene's notes with the place, and whether it was reset before this step. */
static int noted(sp_switch *places, int notes, sp_real force_n)
{
    int whole = notes;
    places->force_n = (double)force_n;
    if (notes >= 0) {
        places->latched = ((unsigned)notes & (unsigned)SP_NOTE_LATCHED) != 0u;
        whole += places->active * (int)SP_SWITCH_PLACE_NOTE;
        whole += (places->reset != 0) ? (int)SP_SWITCH_RESET_NOTE : 0;
        places->reset = 0;
    }
    return whole;
}

int sp_switch_step(sp_switch *places, sp_real position_m, sp_real velocity_mps, sp_real *force_n)
{
    const uint64_t begin_ns = sp_loop_now();
    change_place(places, position_m);
    const sp_switch_scene *scene = &places->scenes[places->active];
    int notes = 0;
    *force_n = 0;
    if (scene->step != NULL) {
        step_function step;
        (void)memcpy(&step, &scene->step, sizeof step);
        notes = step(scene->state, position_m, velocity_mps, force_n);
    }
    uint64_t took_ns = sp_loop_now() - begin_ns;
    places->max_ns = (took_ns > places->max_ns) ? took_ns : places->max_ns;
    if ((places->latency_ns > 0u) && (took_ns > places->latency_ns)) {
        places->overruns++;
    }
    while (took_ns < places->latency_ns) {
        took_ns = sp_loop_now() - begin_ns;
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
        (void)memcpy(&idle, &scene->idle, sizeof idle);
        notes = idle(scene->state, dt_s, force_n);
    }
    return noted(places, notes, *force_n);
}

void sp_switch_reset(sp_switch *places)
{
    places->force_n = 0;
    places->latched = 0;
    reset_scene(places);
}
