/* The loop of a PC on a simulated clock: which period gets which sample, and what is sent. */
#include "simulated_session.h"

enum { TICKS = 400, PERIOD_US = 1000 };

/* One sample comes before the first: the loop begins with the second. */
static int64_t arrivals_us[4 * TICKS];
static int64_t *const arrival_us = arrivals_us + 1;
static int busy_call;    /* the call after which the thread is kept away ... */
static uint64_t busy_us; /* ... so long */
static uint32_t n;
static sp_loop_state end;

static void keep_away(int call)
{
    sim_now_ns += call == busy_call ? 1000u * busy_us : 0;
}

/* A device that sends at its clock; the phase of a sample to its period is what the loop makes it.
 */
static void samples_each(double period_us)
{
    begin_at_work();
    sim_now_ns = 1;
    sim.call_ns = 0;
    sim.in_call = keep_away;
    sim.arrivals_us = arrivals_us;
    sim.count = (int)((TICKS + 20) * PERIOD_US / period_us);
    device.fd = FD;
    busy_call = 0;
    for (int k = 0; k < sim.count; k++) {
        arrivals_us[k] = (int64_t)(100.0 + k * period_us);
    }
}

/* Sample k so much later, and none after it before it. */
static void late(int k, int64_t by_us)
{
    arrival_us[k] += by_us;
    for (int i = k + 1; i < sim.count - 1; i++) {
        if (arrival_us[i] != LOST && arrival_us[i] < arrival_us[k]) {
            arrival_us[i] = arrival_us[k];
        }
    }
}

static void run_loop(void)
{
    sp_loop_config config = usual();
    config.seconds = 1e-6 * PERIOD_US * TICKS;
    config.max_force_n = config.max_depth_m = 1e9;
    n = session(&config, &end);
    CHECK(end.over && end.ticks == n);
    for (uint32_t i = 1; i < n; i++) {
        CHECK(rows[i].time_s >= rows[i - 1].time_s);
    }
}

static int is_idle(uint32_t row)
{
    return (call_of_row(row) & SP_CALL_IDLE) != 0;
}

/* Rows in which not the sample of the same number was used. */
static int out_of_place(void)
{
    int count = 0;
    for (uint32_t i = 0; i < n; i++) {
        count += is_idle(i) || rows[i].position_m != (double)i;
    }
    return count;
}

/* By half a period to two and more: every sample is stepped once, in order, in its period's row,
 * and a force goes out in each period. */
TEST(a_late_sample_is_that_of_its_period)
{
    for (int64_t by_us = 0; by_us <= 2400; by_us += 100) {
        samples_each(PERIOD_US);
        late(100, by_us);
        late(200, by_us);
        run_loop();
        CHECK(out_of_place() == 0 && end.unused == 0 && sim.idles == 0);
        CHECK((uint32_t)sim.writes == n + 3); /* zero three times at the end */
        /* meanwhile what came last was sent again, and the rows say so */
        const int open = (int)rows[100].call & SP_CALL_UNSENT;
        CHECK(sim.written_n[100] == (by_us < 500   ? 101.0
                                     : by_us > 600 ? 100.0
                                                   : sim.written_n[100]));
        CHECK(rows[100].sent_n == (open ? 100.0 : 101.0));
        CHECK(rows[100].returned_n == 101.0);
    }
}

/* Two periods stay open, the others are settled: their samples come too late, and are the oldest.
 */
TEST(a_burst_fills_the_open_periods)
{
    samples_each(PERIOD_US);
    late(100, 12000);
    run_loop();
    CHECK(sim.idles == 10 && (int)end.unused == 10 && out_of_place() == 10);
    CHECK(is_idle(100) && is_idle(109) && rows[110].position_m == 110.0);
    CHECK(end.reason == SP_STOP_TIME);
}

/* The scene hears of each period without a sample, two periods later: so late is its watchdog. */
TEST(silence_reaches_the_scene_two_periods_later)
{
    samples_each(PERIOD_US);
    sim.count = 101;
    busy_call = 100 + 30; /* the 30th idle call */
    busy_us = 1;
    run_loop();
    CHECK(end.reason == SP_STOP_TIME && n >= TICKS - 1);
    CHECK(sim.steps == 100 && sim.idles == (int)n - 100);
    CHECK(sim.writes == (int)n + 3);
}

/* Whole periods and parts of one: no sample is lost to a thread that was kept away. */
TEST(a_late_thread_loses_no_sample)
{
    for (uint64_t us = 0; us <= 200000; us += us < 20000 ? 130 : 60000) {
        samples_each(PERIOD_US);
        busy_call = 100;
        busy_us = us;
        run_loop();
        CHECK(out_of_place() == 0 && sim.idles == 0 && end.unused == 0);
    }
}

/* Late samples and a late thread at once. */
TEST(both_late)
{
    for (uint64_t us = 0; us < 6000; us += 170) {
        for (int64_t by_us = 300; by_us <= 1500; by_us += 300) {
            samples_each(PERIOD_US);
            late(101, by_us);
            busy_call = 100;
            busy_us = us;
            run_loop();
            CHECK(out_of_place() == 0 && sim.idles == 0 && end.unused == 0);
        }
    }
}

/* A faster clock: what is too much is thrown away, and nothing gets older for it. */
TEST(surplus_does_not_pile_up)
{
    const double rates[] = {1.0004, 1.002, 1.01, 1.3, 2.0, 3.0};
    for (unsigned r = 0; r < sizeof rates / sizeof rates[0]; r++) {
        samples_each(PERIOD_US / rates[r]);
        run_loop();
        CHECK(sim.idles == 0);
        CHECK(sim.at - sim.steps - (int)end.unused <= 2 * (int)rates[r] + 2);
        for (uint32_t i = 0; i < n; i++) {
            CHECK(rows[i].age_s < 1.5e-3);
        }
        if (rates[r] >= 2.0) { /* evenly spaced */
            for (uint32_t i = 101; i < n; i++) {
                CHECK(rows[i].position_m - rows[i - 1].position_m == rates[r]);
            }
        }
    }
}

/* A device that sends too seldom: no force after a fifth of the last hundred were missing. */
TEST(too_few_samples_end_it)
{
    const int every[] = {2, 3, 4, 10, 15};
    for (unsigned e = 0; e < sizeof every / sizeof every[0]; e++) {
        samples_each(PERIOD_US * every[e]);
        run_loop();
        CHECK(end.reason == SP_STOP_RATE);
        CHECK(n < 130 && sim.written_n[sim.writes - 1] == 0.0);
        CHECK((int)rows[n - 1].call & SP_CALL_SILENT);
        CHECK(rows[n - 1].sent_n == 0.0);
    }
    samples_each(PERIOD_US); /* three quarters */
    for (int k = 3; k < sim.count; k += 4) {
        arrival_us[k] = LOST;
    }
    run_loop();
    CHECK(end.reason == SP_STOP_RATE);
}

/* Losses that happen, and a silence of any length, are not another rate. */
TEST(losses_do_not_end_it)
{
    samples_each(PERIOD_US);
    uint32_t draw = 1;
    int lost = 0;
    for (int k = 5; k < sim.count - 5; k++) {
        draw = draw * 1664525u + 1013904223u;
        if (draw >> 16 < 655) {
            arrival_us[k] = LOST;
            lost++;
        } else if (draw >> 16 < 655 + 1311) {
            late(k, 900);
        }
    }
    run_loop();
    CHECK(end.reason == SP_STOP_TIME && lost > 0);
    CHECK(sim.idles == lost && out_of_place() == lost && end.unused == 0);

    for (int length = 1; length < 150; length += 7) {
        samples_each(PERIOD_US);
        for (int k = 0; k < length; k++) {
            arrival_us[100 + k] = LOST;
        }
        run_loop();
        CHECK(end.reason == SP_STOP_TIME && sim.idles == length);
    }
    samples_each(PERIOD_US); /* all come, ten at once */
    for (int k = 0; k < sim.count - 1; k++) {
        arrival_us[k] += (9 - k % 10) * PERIOD_US;
    }
    run_loop();
    CHECK(end.reason == SP_STOP_TIME && sim.idles > TICKS / 2);
    samples_each(PERIOD_US); /* a tenth */
    for (int k = 9; k < sim.count; k += 10) {
        arrival_us[k] = LOST;
    }
    run_loop();
    CHECK(end.reason == SP_STOP_TIME);
}

TEST(a_loop_is_joined_once)
{
    samples_each(PERIOD_US);
    run_loop();
    CHECK(sp_loop_join(&self) == 1);
    CHECK(sp_loop_join(&self) == 0);
    CHECK(sim.joins == 1);
}
