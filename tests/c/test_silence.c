#include <math.h>

#include "check.h"
#include "sp_silence.h"

static const sp_silence_config config = {
    .dt_s = (sp_real)0.001, .rate_hz = (sp_real)1000, .watchdog_s = (sp_real)0.0205};

TEST(ticks_without_a_sample_are_counted)
{
    sp_silence_state state = {0};
    for (uint32_t i = 0; i <= 20; i++) {
        CHECK(sp_silence_missed_ticks(&config, &state, config.dt_s) == i);
        CHECK(!state.latched);
        const sp_real latched = sp_silence_no_sample(&config, &state, config.dt_s);
        CHECK(i < 20 ? latched == (sp_real)0 : sp_abs(latched - (sp_real)1) < (sp_real)1e-3);
    }
    CHECK(state.latched);
    CHECK(sp_silence_missed_ticks(&config, &state, config.dt_s) == 0);
}

TEST(measured_times_are_rounded_to_ticks)
{
    sp_silence_state state = {0};
    CHECK(sp_silence_missed_ticks(&config, &state, (sp_real)0.0014) == 0);
    CHECK(sp_silence_missed_ticks(&config, &state, (sp_real)0.0016) == 1);
    (void)sp_silence_no_sample(&config, &state, (sp_real)0.0076);
    CHECK(sp_silence_missed_ticks(&config, &state, config.dt_s) == 8);
    CHECK(sp_silence_missed_ticks(&config, &state, (sp_real)1e-9) == 7);
}

TEST(a_long_silence_is_latched_from_the_watchdog_on)
{
    sp_silence_state state = {0};
    CHECK(sp_abs(sp_silence_no_sample(&config, &state, (sp_real)0.025) - (sp_real)5) <
          (sp_real)1e-3);
    state.silent_s = (sp_real)0; /* a good sample changes nothing */
    CHECK(sp_silence_no_sample(&config, &state, (sp_real)0.002) > (sp_real)1.9);
}

TEST(endless_silence_is_latched)
{
    const sp_real times[] = {(sp_real)1, (sp_real)1e30, (sp_real)INFINITY, (sp_real)NAN};
    for (unsigned i = 0; i < sizeof times / sizeof times[0]; i++) {
        sp_silence_state state = {0};
        (void)sp_silence_no_sample(&config, &state, times[i]);
        CHECK(state.latched);
        CHECK(sp_silence_missed_ticks(&config, &state, config.dt_s) == 0);
    }
}

/* 2 ms of every 14 may be silent, not 3; a third of the ticks ends within 0.1 s. */
TEST(silences_add_up)
{
    const struct {
        int silent, of, ends;
    } cases[] = {{1, 8, 0}, {2, 15, 0}, {19, 142, 0}, {1, 7, 1}, {18, 40, 1}, {1, 3, 1}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_silence_state state = {0};
        int end = 0;
        for (int tick = 0; tick < 20000 && !state.latched; tick++) {
            end = tick;
            if (tick % cases[i].of < cases[i].silent) {
                (void)sp_silence_no_sample(&config, &state, config.dt_s);
            } else {
                sp_silence_good_sample(&state, config.dt_s);
                CHECK(state.silent_s == (sp_real)0);
            }
        }
        CHECK((int)state.latched == cases[i].ends);
        CHECK(cases[i].of > 3 || end < 100);
    }
}

/* A tick of 2^-10 s: all that follows is exact, in float too. */
#define TICK ((sp_real)0.0009765625)
static const sp_silence_config exact = {
    .dt_s = TICK, .rate_hz = (sp_real)1024, .watchdog_s = (sp_real)20.5 * TICK};

TEST(half_a_tick_more_is_a_tick_missed)
{
    const sp_silence_state one = {.silent_s = TICK};
    CHECK(sp_silence_missed_ticks(&exact, &one, (sp_real)0.5 * TICK) == 1);
    CHECK(sp_silence_missed_ticks(&exact, &one, (sp_real)0.375 * TICK) == 0);
    CHECK(sp_silence_missed_ticks(&exact, &one, (sp_real)1.25 * TICK) == 1);
    const sp_silence_state stray = {.silent_s = (sp_real)1e30}; /* 20.5 ticks, and this one */
    CHECK(sp_silence_missed_ticks(&exact, &stray, TICK) == 21);
}

TEST(the_watchdogs_own_time_is_not_latched_and_what_is_begins_anew)
{
    sp_silence_state state = {0};
    CHECK(sp_silence_no_sample(&exact, &state, exact.watchdog_s) == (sp_real)0 && !state.latched);
    CHECK(sp_silence_no_sample(&exact, &state, (sp_real)2048) == (sp_real)1048577);
    CHECK(state.latched && state.silent_s == (sp_real)0 && state.debt_s == (sp_real)0);
}
