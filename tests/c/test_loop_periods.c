/* Periods: when one begins and ends, which sample it gets, how long it stays open for one, and what
 * its row counts. Beside test_loop.c, which runs whole sessions. */
#include "simulated_session.h"

TEST(a_thread_that_is_a_period_late_sends_no_old_force)
{
    for (uint64_t late_ns = PERIOD_NS - 1; late_ns <= PERIOD_NS + 1; late_ns++) {
        sp_loop_state end;
        const sp_loop_config config = usual();
        begin_at_work();
        sim.late_ns = late_ns;
        sim.late_at_ns = START_NS + 10 * PERIOD_NS;
        const uint32_t n = session(&config, &end);
        CHECK(n == 100 && end.late == (late_ns > PERIOD_NS));
        for (uint32_t i = 0; i < n; i++) {
            CHECK(call_of_row(i) == (i == 10 && late_ns >= PERIOD_NS ? SP_CALL_UNSENT : 0));
        }
        CHECK(sim.writes == 103 - (late_ns >= PERIOD_NS));
    }
}

TEST(a_period_stays_open_only_where_its_sample_may_come)
{
    between_ticks();
    CHECK(!may_stay_open(&self)); /* a sample is there whenever it is asked for */
    device.fd = 0;
    CHECK(may_stay_open(&self));
    self.reset_next = 1;
    CHECK(!may_stay_open(&self));
    self.reset_next = 0;
    self.paused = 1;
    CHECK(!may_stay_open(&self));
    self.paused = 0;
    self.link = NULL;
    CHECK(!may_stay_open(&self));
}

/* Twenty without a sample among the last hundred; of a silence, six. */
TEST(too_few_samples_are_counted_in_the_last_hundred)
{
    between_ticks();
    for (int i = 0; i < 1000; i++) { /* 19 in any hundred */
        self.row.call = i % 100 < 38 && i % 2 == 0 ? SP_CALL_IDLE : 0;
        check_rate(&self);
        CHECK(self.reason == 0);
    }
    CHECK(self.idle_count == 19);
    self.row.call = SP_CALL_IDLE; /* in the place of one of them */
    check_rate(&self);
    CHECK(self.reason == 0 && self.idle_count == 19);
    self.row.call = 0;
    check_rate(&self);
    self.row.call = SP_CALL_IDLE;
    check_rate(&self);
    self.row.call = 0;
    check_rate(&self);
    CHECK(self.reason == 0);
    for (int i = 0; i < 2; i++) { /* the place of one that had its sample */
        self.row.call = i ? SP_CALL_IDLE | SP_CALL_RESET : 0;
        for (int k = 0; k < 40; k++) {
            check_rate(&self);
        }
    }
    CHECK(self.idle_run == 40);

    between_ticks();
    for (int i = 0; i < 90; i++) {
        self.row.call = SP_CALL_IDLE;
        check_rate(&self);
        CHECK(self.idle_count == (i < 6 ? i + 1 : 6) && self.idle_run == i + 1);
    }
    self.row.call = 0;
    check_rate(&self);
    CHECK(self.idle_run == 0 && self.idle_count == 6);

    between_ticks();
    for (int i = 0; i < 20; i++) {
        CHECK(self.reason == 0);
        self.row.call = SP_CALL_IDLE;
        check_rate(&self);
        CHECK(self.reason == (i == 19 ? SP_STOP_RATE : 0));
        self.row.call = 0;
        check_rate(&self);
    }
    CHECK(self.idle_count == 20 && self.window_index == 39); /* the last was not looked at */

    for (int why = 0; why < 3; why++) { /* nothing is counted */
        between_ticks();
        self.link = why == 0 ? NULL : &device;
        self.paused = why == 1;
        self.reason = why == 2 ? SP_STOP_DEPTH : 0;
        self.row.call = SP_CALL_IDLE;
        check_rate(&self);
        CHECK(self.idle_count == 0 && self.idle_run == 0 && self.window_index == 0);
    }
}

TEST(samples_that_came_too_late_forgive_the_newest_calls)
{
    for (int at = 0; at < RATE_WINDOW; at += 33) {
        between_ticks();
        self.window_index = at;
        memset(self.was_idle, 1, sizeof self.was_idle);
        self.idle_count = RATE_WINDOW;
        self.was_idle[(at + RATE_WINDOW - 2) % RATE_WINDOW] = 0;
        self.idle_count--;
        sp_loop_uncount_idle(&self, 2);
        CHECK(self.idle_count == RATE_WINDOW - 3);
        for (int back = 1; back <= RATE_WINDOW; back++) {
            CHECK(self.was_idle[(at + RATE_WINDOW - back) % RATE_WINDOW] == (back > 3));
        }
        sp_loop_uncount_idle(&self, 0);
        CHECK(self.idle_count == RATE_WINDOW - 3);
        sp_loop_uncount_idle(&self, 1000); /* more than there are */
        CHECK(self.idle_count == 0);
    }
    between_ticks();
    memset(self.was_idle, 1, sizeof self.was_idle);
    self.idle_count = 7;
    self.idle_run = 3;
    sp_loop_reset_rate_window(&self);
    CHECK(self.idle_count == 0 && self.idle_run == 0);
    CHECK(self.was_idle[0] == 0 && self.was_idle[RATE_WINDOW - 1] == 0);
}

static void asks_in_a_silence(int call)
{
    if (call == 10) {
        sp_loop_request_stop(&self);
    }
}

/* No sample at all: deadlines stay where they are, and open periods get their rows at the end. */
TEST(a_device_that_never_sends_has_all_its_rows)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    for (int asked = 0; asked <= 1; asked++) {
        begin_at_work();
        device.fd = FD;
        sim.read_gives = 0;
        sim.poll_ns = UINT64_MAX / 2;
        sim.in_call = asked ? asks_in_a_silence : NULL;
        const uint32_t n = session(&config, &end);
        CHECK(end.reason == (asked ? SP_STOP_ASKED : SP_STOP_TIME) && n == (asked ? 12 : 100));
        CHECK(sim.idles == (int)n && sim.writes == (int)n + 3);
        for (uint32_t i = 0; i < n; i++) {
            CHECK(isnan(rows[i].measured_n) && call_of_row(i) == (SP_CALL_IDLE | SP_CALL_UNSENT));
            CHECK(is_near(rows[i].time_s - rows[i].lateness_s, 1e-3 * i));
        }
    }
}

/* Its sample came 300 us before the deadline, 50 more than it shall. */
TEST(a_session_follows_the_clock_of_the_device)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    begin_at_work();
    device.fd = FD;
    sim.poll_ns = 900000;
    (void)session(&config, &end);
    CHECK(rows[0].time_s == 0.0 && is_near(rows[0].age_s, 300e-6));
    CHECK(is_near(rows[1].time_s - rows[1].lateness_s, 999.5e-6));
}

/* The first sample may be old; the one after it is not. */
TEST(the_first_deadline_follows_the_second_sample)
{
    between_ticks();
    device.fd = 0;
    sim.poll_ns = 300000;
    self.config.seconds = 0.5;
    first_deadline(&self);
    CHECK(self.waiting_count == 1 && sim.polls == 2);
    CHECK(self.deadline_ns == START_NS + 600000 + PERIOD_NS / 4);
    CHECK(self.start_ns == self.deadline_ns && self.end_ns == self.start_ns + 500000000);
    between_ticks(); /* the second does not come within two periods */
    device.fd = FD;
    sim.poll_ns = 2 * PERIOD_NS + 1;
    first_deadline(&self);
    CHECK(sim.polls == 2 && self.waiting_count == 1);
    CHECK(self.deadline_ns == START_NS + 4 * PERIOD_NS + 1 + PERIOD_NS / 4);
    between_ticks(); /* none for a fifth of a second */
    device.fd = FD;
    sim.poll_ns = 200000001;
    first_deadline(&self);
    CHECK(sim.polls == 2 && self.waiting_count == 0);
    CHECK(self.deadline_ns == START_NS + 202 * PERIOD_NS + PERIOD_NS / 4);
}

TEST(deadlines_follow_the_clock_of_the_device_little_by_little)
{
    const struct {
        int fd, fresh;
        int64_t early_ns, step_ns; /* more than a quarter of a period before the deadline */
    } cases[] = {{FD, 1, 0, 1000000},        {FD, 1, 6400, 999900},    {FD, 1, -6400, 1000100},
                 {0, 1, 6400, 999900},       {FD, 1, 32000, 999500},   {FD, 1, 31999, 999501},
                 {FD, 1, 32064, 999500},     {FD, 1, -32000, 1000500}, {FD, 1, -90000, 1000500},
                 {FD, 1, 240000, 999500},    {FD, 0, 6400, 1000000},   {-1, 1, 6400, 1000000},
                 {FD, 1, 63, 1000000},       {FD, 1, 64, 999999},      {FD, 1, 4160, 999935},
                 {FD, 1, 32064 + 64, 999500}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        between_ticks();
        device.fd = cases[i].fd;
        self.motion.arrived_ns = self.deadline_ns - PERIOD_NS / 4 - (uint64_t)cases[i].early_ns;
        const uint64_t before_ns = self.deadline_ns;
        advance(&self, cases[i].fresh);
        CHECK((int64_t)(self.deadline_ns - before_ns) == cases[i].step_ns);
    }
    between_ticks();
    self.link = NULL;
    uint64_t before_ns = self.deadline_ns;
    advance(&self, 1);
    CHECK(self.deadline_ns - before_ns == PERIOD_NS);
    between_ticks(); /* a twentieth of a percent of any period */
    device.fd = FD;
    self.period_ns = 4 * PERIOD_NS;
    before_ns = self.deadline_ns;
    advance(&self, 1);
    CHECK(self.deadline_ns - before_ns == 4 * PERIOD_NS - 2000);
}

TEST(periods_stay_open_for_two_ms_and_one_at_least)
{
    const struct {
        double rate_hz;
        int open_periods;
    } cases[] = {{100, 1},  {400, 1},   {999, 1},   {1000, 2},  {1500, 2},
                 {2000, 4}, {8000, 16}, {8500, 16}, {20000, 16}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_loop_state end;
        sp_loop_config config = usual();
        config.period_s = 1.0 / cases[i].rate_hz;
        config.seconds = 1e-9;
        begin_at_work();
        (void)session(&config, &end);
        CHECK(self.max_open == cases[i].open_periods);
        CHECK(fabs((double)self.period_ns - 1e9 / cases[i].rate_hz) <= 0.5);
    }
}

TEST(all_that_waits_is_read_and_kept_in_order)
{
    between_ticks();
    sim.read_gives = 3;
    take(&self);
    CHECK(sim.room == MAX_WAITING && self.waiting_count == 3 && self.waiting[2].position_m == 2.25);
    sim.read_gives = MAX_WAITING;
    take(&self);
    CHECK(self.waiting_count == MAX_WAITING);
    sim.read_gives = 0;
    take(&self);
    CHECK(self.waiting_count == MAX_WAITING && self.reason == 0 && self.link == &device);
    sp_loop_consume_samples(&self, MAX_WAITING - 2);
    CHECK(self.waiting_count == 2);
    sim.read_gives =
        MAX_WAITING + 5; /* more than there was room for: the newest of them are here */
    sim.placed = 0;
    take(&self);
    CHECK(sim.placed == MAX_WAITING && self.waiting_count == MAX_WAITING);
}

TEST(samples_are_looked_for_where_and_as_long_as_they_help)
{
    const struct {
        int fd, waiting, open_periods;
        uint64_t late_ns;
        int reads, polls, left;
    } cases[] = {{-1, 0, 0, 0, 1, 0, 1},         {-1, 1, 0, 0, 0, 0, 1},
                 {-1, 1, 1, 0, 1, 0, 2},         {FD, 1, 0, 0, 0, 0, 1},
                 {FD, 2, 0, 0, 0, 0, 1},         {FD, 2, 1, 0, 0, 0, 2},
                 {FD, 2, 0, 250000, 0, 0, 2},    {FD, 2, 0, 249999, 0, 0, 1},
                 {FD, 3, 0, PERIOD_NS, 0, 0, 2}, {FD, 3, 0, PERIOD_NS + 250000, 0, 0, 3},
                 {0, 4, 0, 0, 0, 0, 1}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        between_ticks();
        device.fd = cases[i].fd;
        self.waiting_count = cases[i].waiting;
        self.open_count = cases[i].open_periods;
        self.idle_count = 5;
        memset(self.was_idle, 1, 5);
        self.window_index = 5;
        sp_loop_collect_samples(&self, cases[i].late_ns);
        const int surplus = cases[i].waiting + cases[i].reads - cases[i].left;
        CHECK(sim.reads == cases[i].reads && sim.polls == cases[i].polls);
        CHECK(self.waiting_count == cases[i].left && (int)self.unused == surplus);
        CHECK(self.idle_count == 5 - surplus);
    }
    for (int late = 0; late <= 1; late++) { /* a quarter of a period; not where the tick is late */
        between_ticks();
        device.fd = late ? FD : 0;
        sim.read_gives = 0;
        sim.poll_ns = PERIOD_NS;
        sim_now_ns = self.deadline_ns;
        sp_loop_collect_samples(&self, late ? PERIOD_NS : PERIOD_NS - 1);
        CHECK(sim.polls == !late && sim.reads == 1);
        CHECK(sim_now_ns == self.deadline_ns + (late ? 0 : PERIOD_NS / 4));
    }
    between_ticks();
    self.link = NULL;
    sp_loop_collect_samples(&self, 0);
    CHECK(sim.reads == 0 && sim.sleeps == 0);
}

TEST(a_device_without_a_descriptor_is_not_waited_for)
{
    for (int gone = 0; gone <= 1; gone++) {
        between_ticks();
        self.link = gone ? NULL : &device;
        sp_loop_wait_for_samples(&self, START_NS + 300000, 0);
        CHECK(sim.sleeps == 1 && sim.polls == 0 && sim_now_ns == START_NS + 300000);
    }
    between_ticks();
    device.fd = 0;
    sim.poll_ns = 100000;
    sp_loop_wait_for_samples(&self, START_NS + 300000, 2);
    CHECK(sim.sleeps == 0 && sim.polls == 2 && self.waiting_count == 2);
    sim.poll_ns = 400000;
    sp_loop_wait_for_samples(&self, START_NS + 300000, 0);
    CHECK(sim.polls == 3 && self.waiting_count == 2 && sim_now_ns == START_NS + 300000);
}
