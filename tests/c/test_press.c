/* The force control of a press: bounded both ways, whatever is measured, commanded or lost; nothing
 * after its end but a brake, outwards and short. */
#include "../../runtime_c/port/posix/sp_press.c"

#include "check.h"

enum { ROUNDS = 3000, TICKS = 400 };

static uint32_t seed;

/* From -1 to 1. */
static double any(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (double)(seed >> 8) / 8388608.0 - 1.0;
}

static double any_or_none(double scale)
{
    const double what = any();
    return what > 0.97 ? (double)NAN : what > 0.95 ? 1e300 : scale * any();
}

/* Turns at half a second, then ten fast ones: slow turns between fast ones count nothing. */
TEST(only_turns_that_follow_fast_upon_each_other_are_an_oscillation)
{
    static const uint32_t slow_ticks = 500, fast_ticks = 20;
    for (uint32_t between = 1; between <= 2 * SP_PRESS_TURNS; between++) {
        sp_press press = {.dt_s = 1e-3, .p_gain = 1.0};
        int oscillates = 0;
        for (uint32_t turn = 0; turn < 4 * SP_PRESS_TURNS; turn++) {
            press.tick += turn % between == 0 ? slow_ticks : fast_ticks;
            press.speed_mps = turn % 2 == 0 ? 0.1 : -0.1;
            oscillates = oscillates || is_oscillating(&press);
        }
        CHECK(oscillates == (between > SP_PRESS_TURNS));
    }
}

TEST(a_force_is_within_its_bounds_both_ways)
{
    double command_n[TICKS];
    int pulls = 0, pushes = 0;
    for (uint32_t round = 0; round < ROUNDS; round++) {
        seed = round;
        const double most_n = 1.0 + 9.0 * fabs(any());
        sp_press press = {.command_n = command_n,
                          .n = TICKS,
                          .dt_s = 1e-3,
                          .max_force_n = most_n,
                          .p_gain = 20.0 * fabs(any()),
                          .d_gain_s = 0.1 * fabs(any()),
                          .d_time_s = 1.5e-3,
                          .mass_kg = any() > 0.0 ? 0.3 : 0.0,
                          .damping_nspm = 50.0 * fabs(any()),
                          .pole = 0.55,
                          .resistance_share = 0.01,
                          .sensor_late = 5,
                          .watchdog_s = 0.02,
                          .latched_note = 32,
                          .max_mps = any() > 0.0 ? 0.4 : 0.0};
        double brakes_s = 0.0;
        for (int k = 0; k < TICKS; k++) {
            command_n[k] = 3.0 * most_n * any();
        }
        for (int k = 0; k < TICKS; k++) {
            double force_n = 99.0;
            const double scale_m = 1e-3 * (double)(round % 20);
            press.measured_n = any_or_none(30.0);
            const int latched = press.latched;
            const int notes = any() > -0.9
                                  ? sp_press_step(&press, any_or_none(scale_m), 0.0, &force_n)
                                  : sp_press_idle(&press, 1e-3, &force_n);
            CHECK(fabs(force_n) <= most_n);
            CHECK(notes == (press.latched ? 32 : 0) && press.latched >= latched);
            CHECK(!press.latched || force_n >= 0.0);
            CHECK(!press.latched || press.fault == SP_PRESS_OVERSPEED || force_n == 0.0);
            CHECK(!press.latched || press.speed_mps > 0.0 || force_n == 0.0);
            brakes_s += press.latched && force_n != 0.0 ? 1e-3 : 0.0;
            pulls += force_n == most_n && !press.latched;
            pushes += force_n == -most_n;
        }
        CHECK(brakes_s <= 0.0501);
    }
    CHECK(pulls > ROUNDS && pushes > ROUNDS);
}

static sp_press commanded(const double *command_n)
{
    return (sp_press){.command_n = command_n,
                      .n = TICKS,
                      .dt_s = 1e-3,
                      .max_force_n = 6.0,
                      .watchdog_s = 0.0205,
                      .latched_note = 32,
                      .max_mps = 0.4};
}

TEST(samples_may_be_late_again_and_again_but_not_for_long)
{
    const double command_n[TICKS] = {0.0};
    double force_n = 0.0;
    sp_press press = commanded(command_n);
    for (int k = 0; k < 100; k++) {
        CHECK(sp_press_idle(&press, 1e-3, &force_n) == 0);
        CHECK(k % 20 != 19 || sp_press_step(&press, 0.0, 0.0, &force_n) == 0);
    }
    for (int k = 1; k <= 21; k++) {
        CHECK(sp_press_idle(&press, 1e-3, &force_n) == (k == 21 ? 32 : 0));
    }
}

TEST(the_brake_follows_the_speed_between_its_bounds)
{
    const struct {
        double speed_mps, force_n;
    } cases[] = {{0.125, 0.0}, {0.25, 3.0}, {0.5, 6.0}, {4.0, 6.0}, {5.0, 0.0}, {-0.5, 0.0}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_press press = {.max_force_n = 6.0,
                          .max_mps = 0.5,
                          .dt_s = 1e-3,
                          .fault = SP_PRESS_OVERSPEED,
                          .speed_mps = cases[i].speed_mps};
        CHECK(brake_n(&press) == cases[i].force_n);
    }
}

TEST(a_sensor_may_be_unlike_again_and_again_but_not_for_long)
{
    double command_n[TICKS];
    for (int k = 0; k < TICKS; k++) {
        command_n[k] = 5.0;
    }
    sp_press press = commanded(command_n);
    double force_n = 99.0;
    for (int k = 0; k < 10 * TICKS; k++) {
        press.at = 0;
        press.measured_n = k % TICKS < TICKS - 180 ? 5.0 : 0.0;
        (void)sp_press_step(&press, 0.0, 0.0, &force_n);
    }
    CHECK(press.fault == SP_PRESS_NO_FAULT && force_n == -5.0);
    press.measured_n = 0.0;
    for (int k = 0; k < TICKS; k++) {
        press.at = 0;
        (void)sp_press_step(&press, 0.0, 0.0, &force_n);
    }
    CHECK(press.fault == SP_PRESS_SENSOR_MISMATCH && force_n == 0.0);
}

TEST(a_tool_that_runs_away_is_braked_and_a_false_position_is_not)
{
    for (int is_false = 0; is_false <= 1; is_false++) {
        sp_press press = {.dt_s = 1e-3, .max_force_n = 6.0, .watchdog_s = 0.02, .max_mps = 0.4};
        double force_n = 0.0;
        for (int k = 0; k < 40; k++) {
            const double ran_m = k < 30 ? 0.0 : is_false ? 9.0 : 1e-3 * (k - 30);
            (void)sp_press_step(&press, ran_m, 0.0, &force_n);
            CHECK(!is_false || force_n == 0.0);
        }
        CHECK(press.fault == SP_PRESS_OVERSPEED && (force_n > 0.0) == !is_false);
    }
}
