#include <math.h>

#include "check.h"
#include "sp_output.h"

static const sp_output_config config = {.min_n = (sp_real)0,
                                        .max_n = (sp_real)12,
                                        .slew_n = (sp_real)100,
                                        .rise = (sp_real)0.25,
                                        .fall_nps = (sp_real)1500,
                                        .watchdog_s = (sp_real)0.02,
                                        .dt_s = (sp_real)0.001};

static sp_output_state at_rest(void)
{
    sp_output_state state = {0};
    sp_output_free(&state);
    return state;
}

static void force_stays_within_limits(void)
{
    const struct {
        sp_real in, out;
        int notes;
    } cases[] = {{(sp_real)5, (sp_real)5, 0},
                 {(sp_real)12, (sp_real)12, 0},
                 {(sp_real)13, (sp_real)12, SP_NOTE_CLAMPED},
                 {(sp_real)-1, (sp_real)0, SP_NOTE_CLAMPED},
                 {(sp_real)INFINITY, (sp_real)12, SP_NOTE_LIMITED | SP_NOTE_CLAMPED},
                 {(sp_real)-INFINITY, (sp_real)0, SP_NOTE_LIMITED | SP_NOTE_CLAMPED},
                 {(sp_real)NAN, (sp_real)0, SP_NOTE_CLAMPED}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_output_state state = at_rest();
        int notes = 0;
        CHECK(sp_output_force(&config, &state, cases[i].in, &notes) == cases[i].out);
        CHECK(notes == cases[i].notes);
    }
}

static void force_ramps_in_after_a_restart(void)
{
    sp_output_state state = at_rest();
    sp_output_restart(&state);
    for (int i = 0; i < 4; i++) {
        int notes = 0;
        CHECK(sp_output_force(&config, &state, (sp_real)8, &notes) == (sp_real)(2 * i));
        CHECK(notes == SP_NOTE_RAMPED);
    }
    int notes = 0;
    CHECK(sp_output_force(&config, &state, (sp_real)8, &notes) == (sp_real)8 && notes == 0);
}

static void silence_takes_the_force_to_zero_and_latches(void)
{
    sp_output_state state = at_rest();
    int notes = 0;
    (void)sp_output_force(&config, &state, (sp_real)12, &notes);
    int held = 0;
    int falling = 0;
    sp_real before = (sp_real)12;
    for (int i = 0; i < 60; i++) {
        notes = 0;
        const sp_real force = sp_output_idle(&config, &state, config.dt_s, &notes);
        CHECK(force <= before && force >= (sp_real)0);
        held += notes == SP_NOTE_HELD;
        falling += notes == SP_NOTE_LATCHED && force > (sp_real)0;
        before = force;
    }
    CHECK(held >= 19 && held <= 21);
    CHECK(falling <= 9);
    CHECK(before == (sp_real)0);
    sp_output_watch(&config, &state, config.dt_s, 1);
    notes = 0;
    CHECK(sp_output_force(&config, &state, (sp_real)5, &notes) == (sp_real)0);
    CHECK(notes == SP_NOTE_LATCHED);
}

static void a_good_sample_in_time_keeps_the_force(void)
{
    sp_output_state state = at_rest();
    for (int i = 0; i < 1000; i++) {
        int notes = 0;
        sp_output_watch(&config, &state, config.dt_s, i % 15 == 0);
        CHECK(sp_output_force(&config, &state, (sp_real)5, &notes) == (sp_real)5);
    }
    CHECK(!state.latched);
}

int main(void)
{
    force_stays_within_limits();
    force_ramps_in_after_a_restart();
    silence_takes_the_force_to_zero_and_latches();
    a_good_sample_in_time_keeps_the_force();
    return failed;
}
