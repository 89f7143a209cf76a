#include <math.h>

#include "check.h"
#include "sp_guard.h"
#include "sp_range.h"

static const sp_guard_config config = {
    .jump_m = (sp_real)0.001, .reach_m = (sp_real)10, .resync_ticks = 3};

static void first_believable_sample_is_taken(void)
{
    sp_guard_state state = {0};
    int notes = 0;
    CHECK(sp_guard_position(&config, &state, (sp_real)NAN, &notes) == (sp_real)0);
    CHECK(notes == SP_NOTE_HELD);
    notes = 0;
    CHECK(sp_guard_position(&config, &state, (sp_real)0.5, &notes) == (sp_real)0.5);
    CHECK(notes == SP_NOTE_RESYNC);
}

static void unbelievable_samples_hold_the_last_good_one(void)
{
    const sp_real bad[] = {(sp_real)NAN, (sp_real)INFINITY, (sp_real)-INFINITY,
                           (sp_real)11,  (sp_real)1e30,     (sp_real)0.0021};
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        sp_guard_state state = {0};
        int notes = 0;
        (void)sp_guard_position(&config, &state, (sp_real)0.001, &notes);
        notes = 0;
        CHECK(sp_guard_position(&config, &state, bad[i], &notes) == (sp_real)0.001);
        CHECK(notes == SP_NOTE_HELD);
        notes = 0;
        CHECK(sp_guard_position(&config, &state, (sp_real)0.0015, &notes) == (sp_real)0.0015);
        CHECK(notes == 0);
    }
}

static void agreeing_samples_become_true(void)
{
    sp_guard_state state = {0};
    int notes = 0;
    (void)sp_guard_position(&config, &state, (sp_real)0, &notes);
    const sp_real far[] = {(sp_real)0.02, (sp_real)0.0203, (sp_real)0.0206};
    const int expected[] = {SP_NOTE_HELD, SP_NOTE_HELD, SP_NOTE_RESYNC};
    for (int i = 0; i < 3; i++) {
        notes = 0;
        const sp_real x = sp_guard_position(&config, &state, far[i], &notes);
        CHECK(notes == expected[i]);
        CHECK(x == (i < 2 ? (sp_real)0 : far[2]));
    }
}

static void disagreeing_samples_never_do(void)
{
    sp_guard_state state = {0};
    int notes = 0;
    (void)sp_guard_position(&config, &state, (sp_real)0, &notes);
    for (int i = 0; i < 1000; i++) {
        notes = 0;
        const sp_real x = i % 2 ? (sp_real)0.5 : (sp_real)0.7;
        CHECK(sp_guard_position(&config, &state, x, &notes) == (sp_real)0);
        CHECK(notes == SP_NOTE_HELD);
    }
}

static void device_velocity_is_checked(void)
{
    int notes = 0;
    const sp_real dt = (sp_real)0.001;
    CHECK(sp_guard_velocity(&config, (sp_real)0.9, dt, &notes) == (sp_real)0.9 && notes == 0);
    CHECK(sp_guard_velocity(&config, (sp_real)1.1, dt, &notes) == (sp_real)0);
    CHECK(notes == SP_NOTE_HELD);
    CHECK(sp_guard_velocity(&config, (sp_real)NAN, dt, &notes) == (sp_real)0);
}

static void depth_is_clipped_to_the_trained_range(void)
{
    const sp_range_config range = {.least_m = (sp_real)0, .greatest_m = (sp_real)0.01};
    int notes = 0;
    CHECK(sp_range_clip(&range, (sp_real)-1, &notes) == (sp_real)0 && notes == 0);
    CHECK(sp_range_clip(&range, (sp_real)0.01, &notes) == (sp_real)0.01 && notes == 0);
    CHECK(sp_range_clip(&range, (sp_real)0.011, &notes) == (sp_real)0.01);
    CHECK(notes == SP_NOTE_OUTSIDE);
}

int main(void)
{
    first_believable_sample_is_taken();
    unbelievable_samples_hold_the_last_good_one();
    agreeing_samples_become_true();
    disagreeing_samples_never_do();
    device_velocity_is_checked();
    depth_is_clipped_to_the_trained_range();
    return failed;
}
