/* The output's laws, step by step, by hand. A force may pull, too. */
#include <math.h>

#include "check.h"
#include "sp_output.h"

static const sp_output_config config = {.min_n = (sp_real)-12,
                                        .max_n = (sp_real)16,
                                        .slew_n = (sp_real)4,
                                        .ramp_per_tick = (sp_real)0.25,
                                        .latch_fall_n = (sp_real)1.5};
enum { OTHER_NOTE = 1 << 20 }; /* said before by another unit: it stays, alone */

static sp_output_state after(double last_n)
{
    return (sp_output_state){.last_n = (sp_real)last_n, .ramp = (sp_real)1};
}

static sp_real next(sp_output_state *state, double force_n, int *notes)
{
    return sp_output_limit(&config, state, (sp_real)1, (sp_real)force_n, notes);
}

TEST(what_leaves_is_within_the_limits)
{
    const struct {
        double in, out;
        int notes;
    } cases[] = {{-12, -12, 0},
                 {16, 16, 0},
                 {-13, -12, SP_NOTE_CLAMPED},
                 {17, 16, SP_NOTE_CLAMPED},
                 {(double)INFINITY, 16, SP_NOTE_CLAMPED},
                 {(double)-INFINITY, -12, SP_NOTE_CLAMPED},
                 {(double)NAN, 0, SP_NOTE_CLAMPED}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        int notes = OTHER_NOTE;
        CHECK((double)sp_output_clamp(&config, (sp_real)cases[i].in, &notes) == cases[i].out);
        CHECK(notes == (OTHER_NOTE | cases[i].notes));
        sp_output_state state = after(cases[i].out);
        CHECK((double)next(&state, cases[i].in, &notes) == cases[i].out);
        CHECK((double)state.last_n == cases[i].out);
    }
}

TEST(a_force_grows_by_the_slew_from_what_was_given_and_falls_at_once)
{
    const struct {
        double given, in, out;
    } cases[] = {{3, 9, 7},     {3, 7, 7},       {-3, 9, 4},  {-3, 4, 4},    {-3, -9, -7},
                 {-3, -7, -7},  {3, -9, -4},     {3, -4, -4}, {9, 0.5, 0.5}, {9, 0, 0},
                 {0, 0.5, 0.5}, {0, -0.5, -0.5}, {0, 9, 4},   {-9, 0, 0}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_output_state state = after(cases[i].given);
        int notes = OTHER_NOTE;
        CHECK((double)next(&state, cases[i].in, &notes) == cases[i].out);
        CHECK((double)state.last_n == cases[i].out);
        CHECK(notes == (OTHER_NOTE | (cases[i].in == cases[i].out ? 0 : SP_NOTE_LIMITED)));
    }
}

TEST(a_shorter_call_grows_and_rises_less)
{
    sp_output_state state = after(0);
    int notes = 0;
    CHECK(sp_output_limit(&config, &state, (sp_real)0.5, (sp_real)9, &notes) == (sp_real)2);
    sp_output_state ramp = {0};
    (void)sp_output_limit(&config, &ramp, (sp_real)0.5, (sp_real)8, &notes);
    CHECK(ramp.ramp == (sp_real)0.125);
}

TEST(a_restart_rises_from_zero)
{
    sp_output_state state = after(8);
    sp_output_begin_ramp(&state);
    for (int i = 0; i < 4; i++) {
        int notes = OTHER_NOTE;
        CHECK(next(&state, 8, &notes) == (sp_real)(2 * i));
        CHECK(notes == (OTHER_NOTE | SP_NOTE_RAMPED));
    }
    int notes = 0;
    CHECK(next(&state, 8, &notes) == (sp_real)8 && notes == 0);
    sp_output_begin_ramp(&state);
    sp_output_end_ramp(&state); /* in air: what comes next starts from zero by itself */
    CHECK(next(&state, 3, &notes) == (sp_real)3 && notes == 0);
}

TEST(a_latched_force_falls_for_as_many_ticks_as_passed)
{
    const struct {
        double from, ticks, to;
    } cases[] = {{8, 2, 5}, {-8, 2, -5}, {2, 0.5, 1.25}, {0.5, 0.25, 0.125},
                 {3, 2, 0}, {0, 1, 0},   {-1, 1, 0}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_output_state state = after(cases[i].from);
        int notes = OTHER_NOTE;
        const sp_real force_n =
            sp_output_fall_latched(&config, &state, (sp_real)cases[i].ticks, &notes);
        CHECK((double)force_n == cases[i].to && state.last_n == force_n);
        CHECK(notes == (OTHER_NOTE | SP_NOTE_LATCHED));
    }
}
