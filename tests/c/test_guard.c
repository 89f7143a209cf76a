#include <math.h>

#include "check.h"
#include "sp_guard.h"
#include "sp_guard_velocity.h"
#include "sp_range.h"

static const sp_guard_config config = {
    .jump_m = (sp_real)0.001, .min_m = (sp_real)-10, .max_m = (sp_real)0.1, .resync_ticks = 3};

static void first_believable_sample_is_taken(void)
{
    sp_guard_state state = {0};
    int notes = 0;
    CHECK(sp_guard_position(&config, &state, (sp_real)1, (sp_real)NAN, &notes) == (sp_real)0);
    CHECK(notes == SP_NOTE_HELD);
    notes = 0;
    CHECK(sp_guard_position(&config, &state, (sp_real)1, (sp_real)0.05, &notes) == (sp_real)0.05);
    CHECK(notes == SP_NOTE_RESYNC);
}

static void unbelievable_samples_hold_the_last_good_one(void)
{
    const sp_real bad[] = {(sp_real)NAN, (sp_real)INFINITY, (sp_real)-INFINITY,
                           (sp_real)11,  (sp_real)1e30,     (sp_real)0.0021};
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        sp_guard_state state = {0};
        int notes = 0;
        (void)sp_guard_position(&config, &state, (sp_real)1, (sp_real)0.001, &notes);
        notes = 0;
        CHECK(sp_guard_position(&config, &state, (sp_real)1, bad[i], &notes) == (sp_real)0.001);
        CHECK(notes == SP_NOTE_HELD);
        notes = 0;
        CHECK(sp_guard_position(&config, &state, (sp_real)1, (sp_real)0.0015, &notes) ==
              (sp_real)0.0015);
        CHECK(notes == 0);
    }
}

static void agreeing_samples_become_true(void)
{
    sp_guard_state state = {0};
    int notes = 0;
    (void)sp_guard_position(&config, &state, (sp_real)1, (sp_real)0, &notes);
    const sp_real far[] = {(sp_real)0.02, (sp_real)0.0203, (sp_real)0.0206};
    const int expected[] = {SP_NOTE_HELD, SP_NOTE_HELD, SP_NOTE_RESYNC};
    for (int i = 0; i < 3; i++) {
        notes = 0;
        const sp_real x = sp_guard_position(&config, &state, (sp_real)1, far[i], &notes);
        CHECK(notes == expected[i]);
        CHECK(x == (i < 2 ? (sp_real)0 : far[2]));
    }
}

static void disagreeing_samples_never_do(void)
{
    sp_guard_state state = {0};
    int notes = 0;
    (void)sp_guard_position(&config, &state, (sp_real)1, (sp_real)0, &notes);
    for (int i = 0; i < 1000; i++) {
        notes = 0;
        const sp_real x = i % 2 ? (sp_real)0.05 : (sp_real)0.07;
        CHECK(sp_guard_position(&config, &state, (sp_real)1, x, &notes) == (sp_real)0);
        CHECK(notes == SP_NOTE_HELD);
    }
}

static void a_tool_may_have_moved_in_every_tick_without_a_sample(void)
{
    sp_guard_state state = {0};
    int notes = 0;
    (void)sp_guard_position(&config, &state, (sp_real)1, (sp_real)0, &notes);
    notes = 0;
    CHECK(sp_guard_position(&config, &state, (sp_real)4, (sp_real)0.0039, &notes) ==
          (sp_real)0.0039);
    CHECK(notes == 0);
    (void)sp_guard_position(&config, &state, (sp_real)4, (sp_real)0.0081, &notes);
    CHECK(notes == SP_NOTE_HELD);
}

static void a_shallower_sample_that_is_not_taken_feels_no_more_than_its_depth(void)
{
    const sp_guard_state state = {.good_m = (sp_real)0.008, .started = 1};
    CHECK(sp_guard_share(&config, &state, (sp_real)0.002) == (sp_real)0.25);
    CHECK(sp_guard_share(&config, &state, (sp_real)-0.002) == (sp_real)0);
    CHECK(sp_guard_share(&config, &state, (sp_real)0.01) == (sp_real)1);
    CHECK(sp_guard_share(&config, &state, (sp_real)-11) == (sp_real)1);
    CHECK(sp_guard_share(&config, &state, (sp_real)NAN) == (sp_real)1);
}

static void only_believable_device_velocities_are_taken(void)
{
    const sp_real bad[] = {(sp_real)1.1, (sp_real)-1.1, (sp_real)NAN, (sp_real)INFINITY};
    CHECK(sp_guard_velocity((sp_real)1, (sp_real)0.9));
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CHECK(!sp_guard_velocity((sp_real)1, bad[i]));
    }
}

static void depth_is_clipped_to_the_trained_range(void)
{
    const sp_range_config range = {.min_m = (sp_real)0, .max_m = (sp_real)0.01};
    int notes = 0;
    CHECK(sp_range_clip(&range, (sp_real)0.01, &notes) == (sp_real)0.01 && notes == 0);
    CHECK(sp_range_clip(&range, (sp_real)0.011, &notes) == (sp_real)0.01);
    CHECK(notes == SP_NOTE_OUTSIDE);
    notes = 0;
    CHECK(sp_range_clip(&range, (sp_real)-1, &notes) == (sp_real)0);
    CHECK(notes == SP_NOTE_OUTSIDE);
}

int main(void)
{
    first_believable_sample_is_taken();
    unbelievable_samples_hold_the_last_good_one();
    agreeing_samples_become_true();
    disagreeing_samples_never_do();
    a_tool_may_have_moved_in_every_tick_without_a_sample();
    a_shallower_sample_that_is_not_taken_feels_no_more_than_its_depth();
    only_believable_device_velocities_are_taken();
    depth_is_clipped_to_the_trained_range();
    return failed;
}
