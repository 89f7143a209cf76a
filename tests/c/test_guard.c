#include <math.h>

#include "check.h"
#include "sp_guard.h"

static const sp_guard_config config = {.max_step_m = (sp_real)0.001,
                                       .min_m = (sp_real)-10,
                                       .max_m = (sp_real)0.1,
                                       .air_m = (sp_real)-10,
                                       .resync_ticks = 3};

TEST(unbelievable_samples_hold_the_last_good_one)
{
    const sp_real bad[] = {(sp_real)NAN, (sp_real)INFINITY, (sp_real)-INFINITY,
                           (sp_real)11,  (sp_real)1e30,     (sp_real)0.0021};
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        sp_guard_state state = {0};
        int notes = 0;
        (void)sp_guard_accept(&config, &state, (sp_real)1, (sp_real)0.001, &notes);
        notes = 0;
        CHECK(sp_guard_accept(&config, &state, (sp_real)1, bad[i], &notes) == (sp_real)0.001);
        CHECK(notes == SP_NOTE_HELD);
        notes = 0;
        CHECK(sp_guard_accept(&config, &state, (sp_real)1, (sp_real)0.0015, &notes) ==
              (sp_real)0.0015);
        CHECK(notes == 0);
    }
}

TEST(disagreeing_samples_never_do)
{
    sp_guard_state state = {0};
    int notes = 0;
    (void)sp_guard_accept(&config, &state, (sp_real)1, (sp_real)0, &notes);
    for (int i = 0; i < 1000; i++) {
        notes = 0;
        const sp_real x = i % 2 ? (sp_real)0.05 : (sp_real)0.07;
        CHECK(sp_guard_accept(&config, &state, (sp_real)1, x, &notes) == (sp_real)0);
        CHECK(notes == SP_NOTE_HELD);
    }
}

TEST(a_shallower_sample_that_is_not_taken_feels_no_more_than_its_depth)
{
    const sp_guard_state state = {.last_good_m = (sp_real)0.008, .started = 1};
    CHECK(sp_guard_held_fraction(&config, &state, (sp_real)0.002) == (sp_real)0.25);
    CHECK(sp_guard_held_fraction(&config, &state, (sp_real)-0.002) == (sp_real)0);
    CHECK(sp_guard_held_fraction(&config, &state, (sp_real)0.01) == (sp_real)1);
    CHECK(sp_guard_held_fraction(&config, &state, (sp_real)-11) == (sp_real)1);
    CHECK(sp_guard_held_fraction(&config, &state, (sp_real)NAN) == (sp_real)1);
}

/* A tool flies through the air as fast as it likes, and is not let in by that. */
TEST(any_step_in_the_air_is_plausible)
{
    sp_guard_config surface = config;
    surface.air_m = (sp_real)0;
    sp_guard_state state = {.last_good_m = (sp_real)-0.5, .started = 1};
    int notes = 0;
    CHECK(sp_guard_accept(&surface, &state, (sp_real)1, (sp_real)-2, &notes) == (sp_real)-2);
    CHECK(sp_guard_accept(&surface, &state, (sp_real)1, (sp_real)0, &notes) == (sp_real)0);
    CHECK(sp_guard_accept(&surface, &state, (sp_real)1, (sp_real)-2, &notes) == (sp_real)-2);
    CHECK(notes == 0);
    state.last_good_m = (sp_real)-0.5;
    CHECK(sp_guard_accept(&surface, &state, (sp_real)1, (sp_real)0.01, &notes) == (sp_real)-0.5);
    CHECK(notes == SP_NOTE_HELD);
    state.last_good_m = (sp_real)0.01;
    notes = 0;
    CHECK(sp_guard_accept(&surface, &state, (sp_real)1, (sp_real)-0.5, &notes) == (sp_real)0.01);
    CHECK(notes == SP_NOTE_HELD);
}

/* Numbers that float holds exactly: at a border, not near it. */
static const sp_guard_config exact = {.max_step_m = (sp_real)0.25,
                                      .min_m = (sp_real)-8,
                                      .max_m = (sp_real)8,
                                      .air_m = (sp_real)-8,
                                      .resync_ticks = 3};
enum { OTHER_NOTE = SP_NOTE_RAMPED }; /* said before by another unit: it stays */

/* Takes a sample one tick after the last; whether position and notes are these. */
static int gives(sp_guard_state *state, double x, double expected_m, int expected_notes)
{
    int notes = OTHER_NOTE;
    const sp_real position_m = sp_guard_accept(&exact, state, (sp_real)1, (sp_real)x, &notes);
    return position_m == (sp_real)expected_m && notes == (OTHER_NOTE | expected_notes);
}

TEST(borders_themselves_are_believable)
{
    const double borders[] = {-8, 8};
    for (int i = 0; i < 2; i++) {
        sp_guard_state state = {0};
        CHECK(gives(&state, borders[i] * 1.001, 0, SP_NOTE_HELD));
        CHECK(gives(&state, borders[i], borders[i], SP_NOTE_RESYNC));
    }
}

TEST(a_step_as_long_as_the_longest_is_taken)
{
    sp_guard_state state = {0};
    CHECK(gives(&state, 0, 0, SP_NOTE_RESYNC));
    for (int i = 1; i <= 8; i++) {
        CHECK(gives(&state, 0.25 * i, 0.25 * i, 0));
    }
    CHECK(gives(&state, (double)NAN, 2, SP_NOTE_HELD));
    CHECK(gives(&state, 4, 2, SP_NOTE_HELD));
    CHECK(gives(&state, 4.25, 2, SP_NOTE_HELD));
    CHECK(gives(&state, 4, 4, SP_NOTE_RESYNC));
    CHECK(gives(&state, (double)NAN, 4, SP_NOTE_HELD));
    CHECK(gives(&state, 4.25, 4.25, 0));
}

/* What has just become true is no suspect: a step that is too long for half a tick begins at one.
 */
TEST(after_a_new_position_suspects_are_counted_anew)
{
    sp_guard_state state = {0};
    CHECK(gives(&state, 0, 0, SP_NOTE_RESYNC));
    CHECK(gives(&state, 4, 0, SP_NOTE_HELD));
    CHECK(gives(&state, 4, 0, SP_NOTE_HELD));
    CHECK(gives(&state, 4, 4, SP_NOTE_RESYNC));
    for (int i = 1; i <= 3; i++) {
        int notes = 0;
        const sp_real x = (sp_real)(4 + 0.1875 * i);
        const sp_real position_m = sp_guard_accept(&exact, &state, (sp_real)0.5, x, &notes);
        CHECK(position_m == (i < 3 ? (sp_real)4 : x));
        CHECK(notes == (i < 3 ? SP_NOTE_HELD : SP_NOTE_RESYNC));
    }
}

/* Between samples that agree, a good one or one that cannot be: they begin again. */
TEST(only_samples_in_a_row_agree)
{
    const double between[] = {0.125, (double)NAN, 9};
    for (int i = 0; i < 3; i++) {
        sp_guard_state state = {0};
        CHECK(gives(&state, 0, 0, SP_NOTE_RESYNC));
        CHECK(gives(&state, 4, 0, SP_NOTE_HELD));
        CHECK(gives(&state, 4, 0, SP_NOTE_HELD));
        const double held = i == 0 ? 0.125 : 0;
        CHECK(gives(&state, between[i], held, i == 0 ? 0 : SP_NOTE_HELD));
        CHECK(gives(&state, 4, held, SP_NOTE_HELD));
        CHECK(gives(&state, 4, held, SP_NOTE_HELD));
        CHECK(gives(&state, 4, 4, SP_NOTE_RESYNC));
    }
}

TEST(a_share_is_zero_at_the_surface_and_one_without_depth)
{
    const sp_guard_state deep = {.last_good_m = (sp_real)0.008, .started = 1};
    const sp_guard_state surface = {.started = 1};
    CHECK(sp_guard_held_fraction(&config, &deep, (sp_real)1e-31) == (sp_real)0);
    CHECK(sp_guard_held_fraction(&config, &deep, (sp_real)0) == (sp_real)0);
    CHECK(sp_guard_held_fraction(&config, &surface, (sp_real)-0.002) == (sp_real)0);
}

TEST(a_way_stays_within_the_believable_positions)
{
    const sp_real inside[] = {config.min_m, (sp_real)0.05, config.max_m};
    for (int i = 0; i < 3; i++) {
        CHECK(sp_guard_clamp(&config, inside[i]) == inside[i]);
    }
    CHECK(sp_guard_clamp(&config, config.max_m + (sp_real)1) == config.max_m);
    CHECK(sp_guard_clamp(&config, config.min_m - (sp_real)1) == config.min_m);
}
