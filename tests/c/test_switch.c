/* Scenes in one loop: what is felt changes only above the surface, where the last force has faded
 * and no watchdog has latched. Of scenes that give and note whatever a test says. */
#include "../../runtime_c/port/posix/sp_switch.c"

#include "check.h"

enum { ROUNDS = 2000, TICKS = 200 };

static struct {
    sp_real force_n;
    int latches; /* until its reset */
    int latched;
} scenes[SP_SWITCH_PLACES];

static uint32_t seed;

static uint32_t any(uint32_t below)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % below;
}

uint64_t sp_loop_now(void)
{
    return 0;
}

static int call(void *state, sp_real *force_n)
{
    const int place = *(int *)state;
    scenes[place].latched = scenes[place].latched || scenes[place].latches;
    *force_n = scenes[place].force_n;
    return scenes[place].latched ? SP_NOTE_LATCHED : 0;
}

static int step(void *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n)
{
    (void)position_m;
    (void)velocity_mps;
    return call(state, force_n);
}

static int idle(void *state, sp_real dt_s, sp_real *force_n)
{
    (void)dt_s;
    return call(state, force_n);
}

static void reset(void *state)
{
    scenes[*(int *)state].latched = 0;
}

static int numbers[SP_SWITCH_PLACES] = {0, 1, 2, 3};

static sp_switch with_scenes(void)
{
    sp_switch places = {.faded_n = 1e-3};
    int (*const steps)(void *, sp_real, sp_real, sp_real *) = step;
    int (*const idles)(void *, sp_real, sp_real *) = idle;
    void (*const resets)(void *) = reset;
    memset(scenes, 0, sizeof scenes);
    for (int place = 1; place < SP_SWITCH_PLACES - 1; place++) { /* place 3: a real object */
        sp_switch_scene *scene = &places.scenes[place];
        memcpy(&scene->step, &steps, sizeof scene->step);
        memcpy(&scene->idle, &idles, sizeof scene->idle);
        memcpy(&scene->reset, &resets, sizeof scene->reset);
        scene->state = &numbers[place];
    }
    return places;
}

static sp_real any_force_n(void)
{
    static const sp_real forces_n[] = {0, (sp_real)5e-4, (sp_real)2e-3, (sp_real)-2e-3, 3};
    return forces_n[any(sizeof forces_n / sizeof *forces_n)];
}

/* Whatever is wanted, at any tick, in any order of samples and silences. */
TEST(what_is_felt_changes_only_in_quiet)
{
    for (uint32_t round = 0; round < ROUNDS; round++) {
        sp_switch places = with_scenes();
        sp_real last_n = 0;
        int latched = 0;
        seed = round;
        for (int tick = 0; tick < TICKS; tick++) {
            const int before = sp_switch_active(&places);
            const sp_real position_m = (sp_real)1e-3 * (sp_real)((int)any(3) - 1);
            const int sample = any(4) > 0;
            sp_real force_n = 9;
            if (any(3) == 0) {
                sp_switch_want(&places, (int32_t)any(6) - 1);
            }
            if (any(50) == 0) {
                sp_switch_reset(&places);
                latched = 0;
                last_n = 0;
            }
            for (int place = 1; place < SP_SWITCH_PLACES; place++) {
                scenes[place].force_n = any_force_n();
                scenes[place].latches = any(30) == 0;
            }
            const int wanted = places.wanted;
            const int notes = sample ? sp_switch_step(&places, position_m, 0, &force_n)
                                     : sp_switch_idle(&places, 1, &force_n);
            const int changes = sample && position_m <= 0 && fabs((double)last_n) <= 1e-3 &&
                                !latched && wanted >= 0 && wanted < SP_SWITCH_PLACES;
            CHECK(sp_switch_active(&places) == (changes ? wanted : before));
            CHECK(notes / SP_SWITCH_PLACE_NOTE % SP_SWITCH_PLACES == sp_switch_active(&places));
            CHECK(!latched || (notes & SP_NOTE_LATCHED));
            latched = (notes & SP_NOTE_LATCHED) != 0;
            last_n = force_n;
        }
    }
}
