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

/* A source that is silent for a seventh of the time ends, for a third of it within half a second;
 * one that loses 1 % in bursts of 14 ms, or 19 ms of every 142, goes on. */
TEST(silences_add_up)
{
    const struct {
        int silent, of, end_before;
    } cases[] = {{1, 8, 0},      {2, 15, 0},    {19, 142, 0}, {14, 1400, 0}, {1, 7, 60000},
                 {6, 42, 60000}, {18, 40, 500}, {1, 3, 500},  {1, 2, 500},   {6, 18, 500}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_silence_state state = {0};
        int end = 0;
        for (int tick = 0; tick < 60000 && !state.latched; tick++) {
            end = tick;
            if (tick % cases[i].of < cases[i].silent) {
                (void)sp_silence_no_sample(&config, &state, config.dt_s);
            } else {
                sp_silence_good_sample(&state, config.dt_s);
                CHECK(state.silent_s == (sp_real)0);
            }
        }
        CHECK((int)state.latched == (cases[i].end_before > 0));
        CHECK(!state.latched || end < cases[i].end_before);
    }
}

/* Half an hour of bursts of 1 to 14 ms at random, 1 % of the time: none latches. */
TEST(rare_bursts_at_random_latch_never)
{
    sp_silence_state state = {0};
    uint32_t random = 1, lost = 0, left = 0;
    for (int tick = 0; tick < 1800000; tick++) {
        random = random * 1664525u + 1013904223u;
        if (left == 0 && (random >> 8) % 750u == 0u) {
            left = 1u + (random >> 4) % 14u;
        }
        if (left > 0) {
            left--;
            lost++;
            (void)sp_silence_no_sample(&config, &state, config.dt_s);
        } else {
            sp_silence_good_sample(&state, config.dt_s);
        }
    }
    CHECK(!state.latched);
    CHECK(lost > 15000 && lost < 21000);
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

/* Five timeouts of 20.5 ticks: at 102.5 nothing, a tick more is latched for one tick. */
TEST(a_debt_of_five_timeouts_is_the_most)
{
    sp_silence_state state = {.debt_s = (sp_real)101.5 * TICK};
    CHECK(sp_silence_no_sample(&exact, &state, TICK) == (sp_real)0 && !state.latched);
    sp_silence_good_sample(&state, TICK);
    state.debt_s = (sp_real)102.5 * TICK;
    CHECK(sp_silence_no_sample(&exact, &state, TICK) == (sp_real)1 && state.latched);
    sp_silence_state longer = {.debt_s = (sp_real)100.5 * TICK};
    CHECK(sp_silence_no_sample(&exact, &longer, (sp_real)8 * TICK) == (sp_real)7);
    CHECK(longer.latched);
}
