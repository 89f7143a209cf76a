#include <math.h>

#include "check.h"
#include "sp_output.h"

static const sp_output_config config = {.min_n = (sp_real)0,
                                        .max_n = (sp_real)12,
                                        .slew_n = (sp_real)100,
                                        .rise = (sp_real)0.25,
                                        .fall_n = (sp_real)1.5,
                                        .return_n = (sp_real)0.08};

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
        CHECK(sp_output_force(&config, &state, (sp_real)1, cases[i].in, &notes) == cases[i].out);
        CHECK(notes == cases[i].notes);
    }
}

static void force_ramps_in_after_a_restart(void)
{
    sp_output_state state = at_rest();
    sp_output_restart(&state);
    for (int i = 0; i < 4; i++) {
        int notes = 0;
        CHECK(sp_output_force(&config, &state, (sp_real)1, (sp_real)8, &notes) == (sp_real)(2 * i));
        CHECK(notes == SP_NOTE_RAMPED);
    }
    int notes = 0;
    CHECK(sp_output_force(&config, &state, (sp_real)1, (sp_real)8, &notes) == (sp_real)8 &&
          notes == 0);
}

/* The model's force grew by 0.5 N in each of ten ticks without a sample, and stays there. */
static void after_a_silence_the_force_comes_back_little_by_little(void)
{
    sp_output_state state = at_rest();
    int notes = 0;
    (void)sp_output_force(&config, &state, (sp_real)1, (sp_real)2, &notes);
    (void)sp_output_force(&config, &state, (sp_real)1, (sp_real)2, &notes);
    for (int i = 0; i < 9; i++) {
        sp_output_wait(&config, &state, (sp_real)1);
        CHECK(state.force_n == (sp_real)2);
    }
    sp_real last = (sp_real)2;
    int arrived = 0;
    for (int i = 0; i < 60 && !arrived; i++) {
        notes = 0;
        const sp_real ticks = (sp_real)(i == 0 ? 10 : 1);
        const sp_real force = sp_output_force(&config, &state, ticks, (sp_real)7, &notes);
        CHECK(force > last && force - last <= (sp_real)0.7);
        arrived = force == (sp_real)7;
        CHECK(notes == (arrived ? 0 : SP_NOTE_LIMITED));
        last = force;
    }
    CHECK(arrived);
    notes = 0;
    CHECK(sp_output_force(&config, &state, (sp_real)1, (sp_real)12, &notes) == (sp_real)12);
}

static void without_samples_the_force_goes_on_less_and_less(void)
{
    sp_output_state state = at_rest();
    int notes = 0;
    (void)sp_output_force(&config, &state, (sp_real)1, (sp_real)5, &notes);
    (void)sp_output_force(&config, &state, (sp_real)1, (sp_real)5.1, &notes);
    sp_real last = state.force_n, step = (sp_real)0.1001;
    for (int i = 0; i < 100; i++) {
        sp_output_wait(&config, &state, (sp_real)1);
        CHECK(state.force_n >= last && state.force_n - last <= step);
        step = state.force_n - last + (sp_real)1e-6;
        last = state.force_n;
    }
    CHECK(last > (sp_real)6 && last < (sp_real)6.11); /* ten times the last change, at most */
}

static void endless_forces_after_a_silence_stay_within_limits(void)
{
    const sp_real from[] = {(sp_real)NAN, (sp_real)INFINITY, (sp_real)-INFINITY, (sp_real)1e30};
    for (unsigned i = 0; i < sizeof from / sizeof from[0]; i++) {
        sp_output_state state = at_rest();
        int notes = 0;
        (void)sp_output_force(&config, &state, (sp_real)1, (sp_real)6, &notes);
        (void)sp_output_force(&config, &state, (sp_real)5, from[i], &notes);
        for (int k = 0; k < 100; k++) {
            CHECK(state.force_n >= config.min_n && state.force_n <= config.max_n);
            sp_output_wait(&config, &state, (sp_real)3);
        }
    }
}

int main(void)
{
    force_stays_within_limits();
    force_ramps_in_after_a_restart();
    after_a_silence_the_force_comes_back_little_by_little();
    without_samples_the_force_goes_on_less_and_less();
    endless_forces_after_a_silence_stay_within_limits();
    return failed;
}
