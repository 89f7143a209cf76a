/* What ends a session, and with which reason: limits, an asked-for end, a replay over, a trip of
 * the watchdog; and what its rows and its status say. */
#include "simulated_session.h"

TEST(a_row_says_when_and_with_what_the_scene_was_called)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    begin_at_work();
    sim.notes = 4;
    sim.late_ns = 125000;
    sim.late_at_ns = START_NS + 10 * PERIOD_NS;
    const uint32_t n = session(&config, &end);
    CHECK(n == 100 && end.reason == SP_STOP_TIME && end.over == 1 && end.got == 42);
    CHECK(sim.steps == 100 && sim.idles == 0 && sim.resets == 0 && end.ticks == 100);
    for (uint32_t i = 0; i < n; i++) {
        const double late_s = i == 10 ? 125e-6 : 0.0;
        CHECK(is_near(rows[i].time_s, 1e-3 * i + late_s) && is_near(rows[i].lateness_s, late_s));
        CHECK(is_near(rows[i].tick_s, 250e-6) && is_near(rows[i].age_s, 50e-6));
        CHECK(rows[i].dt_s == (double)(sp_real)1e-3);
        CHECK(rows[i].position_m == 0.25 && rows[i].velocity_mps == -0.125);
        CHECK(rows[i].measured_n == 1.5 && rows[i].notes == 4.0 && rows[i].call == 0.0);
        CHECK(rows[i].returned_n == 2.0 && rows[i].sent_n == 2.0);
        CHECK(sim.written_n[i] == 2.0);
    }
    CHECK(sim.velocity_mps == -0.125 && sim.measured_seen_n == 1.5);
    CHECK(sim.writes == 103 && sim.written_n[100] == 0.0 && sim.written_n[102] == 0.0);
    CHECK(is_near(end.elapsed_s, 0.09925) && end.newest_row == 100 && end.connected == 1);
    CHECK(end.late == 0 && end.stale == 0 && end.unused == 0 && end.ring_dropped == 0);
    CHECK(self.max_open == 2 && sp_loop_size() == sizeof(sp_loop));
}

static int force_call;
static double force_then_n;
static int notes_then;
static sp_motion motion_then;

static void after_ten_calls(int call)
{
    if (call == force_call - 1) { /* read before the next */
        sim.motion = motion_then;
    } else if (call == force_call) {
        sim.notes = notes_then;
    }
    sim.force_n = call >= force_call - 1 ? force_then_n : 2.0;
}

/* At the eleventh call: reason, or 0 where it goes on; no such force leaves. */
TEST(each_limit_ends_it_with_no_force)
{
    const sp_motion still = {.position_m = 0.25, .velocity_mps = -0.125, .measured_n = (double)NAN};
    const struct {
        double force_n, max_n, measured_n, position_m;
        int notes, reason;
    } cases[] = {{2, 10, 1.5, 0.25, 0, 0},
                 {10, 10, 1.5, 0.25, 0, 0},
                 {-10, 10, -10, 0.25, 0, 0},
                 {10.5, 10, 1.5, 0.25, 0, SP_STOP_FORCE},
                 {-10.5, 10, 1.5, 0.25, 0, SP_STOP_FORCE},
                 {(double)NAN, 10, 1.5, 0.25, 0, SP_STOP_FORCE},
                 {(double)INFINITY, (double)INFINITY, 1.5, 0.25, 0, SP_STOP_FORCE},
                 {2, 10, 10.5, 0.25, 0, SP_STOP_FORCE},
                 {2, 10, -10.5, 0.25, 0, SP_STOP_FORCE},
                 {2, 10, (double)INFINITY, 0.25, 0, SP_STOP_FORCE},
                 {2, 10, (double)NAN, 0.25, 0, 0},
                 {2, 10, 1.5, 0.5, 0, 0},
                 {2, 10, 1.5, 0.625, 0, SP_STOP_DEPTH},
                 {10.5, 10, 1.5, 0.625, 0, SP_STOP_FORCE},
                 {10.5, 10, 1.5, 0.25, -1, SP_STOP_MISUSE},
                 {2, 10, 1.5, 0.25, -1, SP_STOP_MISUSE}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_loop_state end;
        sp_loop_config config = usual();
        begin_at_work();
        config.max_force_n = cases[i].max_n;
        force_call = 11;
        force_then_n = cases[i].force_n;
        notes_then = cases[i].notes;
        motion_then = still;
        motion_then.measured_n = cases[i].measured_n;
        motion_then.position_m = cases[i].position_m;
        sim.in_call = after_ten_calls;
        const uint32_t n = session(&config, &end);
        const int ends = cases[i].reason != 0;
        CHECK(end.reason == (ends ? cases[i].reason : SP_STOP_TIME));
        CHECK(n == (ends ? 11 : 100) && sim.writes == (int)n + 3);
        for (int k = 0; k < sim.writes; k++) {
            const double expected_n = k < 10 ? 2.0 : ends || k >= (int)n ? 0.0 : cases[i].force_n;
            CHECK(sim.written_n[k] == expected_n);
        }
        CHECK(call_of_row(10) == (ends ? SP_CALL_SILENT : 0));
        CHECK(rows[10].sent_n == (ends ? 0.0 : cases[i].force_n));
    }
}

static void asks_to_end(int call)
{
    if (call == 1500) {
        sp_loop_request_stop(&self);
    }
}

TEST(without_a_time_it_runs_until_it_is_asked)
{
    sp_loop_state end;
    sp_loop_config config = usual();
    config.seconds = 0;
    begin_at_work();
    sim.in_call = asks_to_end;
    CHECK(session(&config, &end) == 1500 && end.reason == SP_STOP_ASKED);
    CHECK(sim.writes == 1503 && sim.written_n[1500] == 0.0 && sim.written_n[1499] == 2.0);
    CHECK(sim.reads == 1500);
}

static void replay_ends(int call)
{
    sim.read_gives = call >= 20 ? SP_LINK_ENDED : 1;
}

TEST(the_end_of_a_replay_ends_it)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    begin_at_work();
    sim.in_call = replay_ends;
    CHECK(session(&config, &end) == 20 && end.reason == SP_STOP_ENDED);
    CHECK(sim.writes == 23 && sim.written_n[20] == 0.0 && sim.idles == 0);
    CHECK(is_near(end.elapsed_s, 0.01925) && end.start_ns == self.start_ns);
    const int gives[] = {SP_LINK_ENDED, SP_LINK_BUTTON, 0};
    const int ends[] = {SP_STOP_ENDED, SP_STOP_BUTTON, 0};
    for (int i = 0; i < 3; i++) {
        for (int before = 0; before <= SP_STOP_FORCE; before += SP_STOP_FORCE) {
            between_ticks();
            sim.read_gives = gives[i];
            self.reason = before; /* the first reason counts */
            take(&self);
            CHECK(self.reason == (before ? before : ends[i]));
        }
    }
}

static void latches(int call)
{
    sim.notes = (call >= 9 && call <= 11) || call == 20 ? LATCHED | 1 : 1;
}

TEST(each_trip_of_the_watchdog_is_counted_once)
{
    sp_loop_state end;
    sp_loop_config config = usual();
    begin_at_work();
    sim.in_call = latches;
    (void)session(&config, &end);
    CHECK(end.watchdog_trips == 2 && end.latched == 0);
    config.seconds = 0.011;
    begin_at_work();
    sim.in_call = latches;
    (void)session(&config, &end);
    CHECK(end.watchdog_trips == 1 && end.latched == 1 && end.tripped == 0);
    between_ticks();
    const sp_period period = {.begin_ns = START_NS};
    const struct {
        int notes, latched;
    } cases[] = {{LATCHED, 1}, {LATCHED + 3, 1}, {0, 0}, {1, 0}, {-1, 0}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        between_ticks();
        sim.notes = cases[i].notes;
        run_period(&self, &period, START_NS, 0);
        CHECK(self.latched == cases[i].latched && (int)self.trips == cases[i].latched);
        CHECK(self.row.notes == cases[i].notes);
    }
}

TEST(idle_takes_the_last_force_where_the_scene_gives_none)
{
    const sp_period period = {.begin_ns = START_NS};
    between_ticks();
    self.row.returned_n = 3.0;
    sim.notes = -1;
    run_period(&self, &period, START_NS, 0);
    CHECK(self.row.returned_n == 3.0 && self.reason == SP_STOP_MISUSE);
    CHECK(isnan(self.row.age_s));
}

/* A period that was open when its limit was met: zero goes out at once. */
TEST(an_open_period_that_meets_a_limit_ends_it)
{
    const int gives[] = {0, 1};
    for (int i = 0; i < 4; i++) {
        const int fresh = i / 2, unsent = gives[i % 2];
        between_ticks();
        const sp_period open = {.begin_ns = START_NS, .deadline_ns = START_NS, .sent_n = 1.0};
        sim.force_n = 99.0;
        sim.write_gives = unsent;
        self.sent_n = 7.0;
        self.waiting_count = 1;
        close_open_period(&self, &open, START_NS, fresh);
        CHECK(self.reason == SP_STOP_FORCE && sim.writes == 1 && sim.written_n[0] == 0.0);
        CHECK(sp_loop_drain(&self, rows, 9) == 1 && rows[0].sent_n == (unsent ? 7.0 : 0.0));
        CHECK(call_of_row(0) ==
              (SP_CALL_SILENT | (fresh ? 0 : SP_CALL_IDLE) | (unsent ? SP_CALL_UNSENT : 0)));
    }
    between_ticks();
    const sp_period open = {.begin_ns = START_NS, .deadline_ns = START_NS, .sent_n = 1.0};
    close_open_period(&self, &open, START_NS, 0);
    CHECK(self.reason == 0 && sim.writes == 0);
    CHECK(sp_loop_drain(&self, rows, 9) == 1 && rows[0].sent_n == 1.0);
    CHECK(call_of_row(0) == (SP_CALL_IDLE | SP_CALL_UNSENT));
}

/* A late tick leaves its force to the next one, but a zero goes out. */
TEST(a_late_tick_that_meets_a_limit_sends_zero)
{
    for (int late = 0; late < 2; late++) {
        for (int limit = 0; limit < 2; limit++) {
            between_ticks();
            sim.force_n = limit ? 99.0 : 0.5;
            self.waiting_count = 1;
            CHECK(sp_loop_tick(&self, late) == 1);
            CHECK(self.reason == (limit ? SP_STOP_FORCE : 0));
            CHECK(sim.writes == (limit || !late ? 1 : 0));
            CHECK(limit == 0 || (sim.written_n[0] == 0.0 && self.row.sent_n == 0.0));
        }
    }
}

TEST(the_status_is_that_of_the_loop)
{
    sp_loop_state state;
    between_ticks();
    self.ticks = 1;
    self.late = 2;
    self.stale = 3;
    self.unused = 4;
    self.ring.dropped = 5;
    self.trips = 6;
    self.disconnects = 7;
    self.resets = 8;
    self.ring.head = 9;
    self.begun_ns = 10;
    self.elapsed_ns = 1500000000;
    self.latched = 11;
    self.tripped = 12;
    self.tripped_before_disconnect = 13;
    self.connected = 14;
    self.paused = 15;
    self.reason = 16;
    self.over = 17;
    self.got = 18;
    sp_loop_get_status(&self, &state);
    CHECK(state.start_ns == 10);
    CHECK(state.ticks == 1 && state.late == 2 && state.stale == 3 && state.unused == 4);
    CHECK(state.ring_dropped == 5 && state.watchdog_trips == 6 && state.disconnects == 7);
    CHECK(state.resets == 8 && state.newest_row == 9 && is_near(state.elapsed_s, 1.5));
    CHECK(state.latched == 11 && state.tripped == 12 && state.tripped_before_disconnect == 13);
    CHECK(state.connected == 14 && state.paused == 15 && state.reason == 16);
    CHECK(state.over == 17 && state.got == 18);
}
