/* A device that is gone, not at work, comes back, or is asked to reset: it gets no force that it
 * must not get, and each reset once. */
#include "simulated_session.h"

TEST(a_reset_comes_before_one_call)
{
    for (int fresh = 0; fresh <= 1; fresh++) {
        const sp_period period = {.begin_ns = START_NS};
        between_ticks();
        self.waiting_count = 1;
        self.reset_next = 1;
        run_period(&self, &period, START_NS, fresh);
        CHECK(sim.resets == 1 && self.resets == 1 && self.reset_next == 0);
        CHECK((int)self.row.call == (SP_CALL_RESET | (fresh ? 0 : SP_CALL_IDLE)));
        self.waiting_count = 1;
        run_period(&self, &period, START_NS, fresh);
        CHECK(sim.resets == 1 && (int)self.row.call == (fresh ? 0 : SP_CALL_IDLE));
    }
}

TEST(a_sensor_beside_the_device_is_believed_for_a_tenth_of_a_second)
{
    between_ticks();
    self.config.sensed = 1;
    CHECK(isnan(sensed_n(&self, START_NS))); /* it has not said anything */
    CHECK(isnan(sensed_n(&self, 50000000)));
    sp_loop_set_measured_force(&self, 4.0);
    CHECK(sensed_n(&self, START_NS) == 4.0 && sensed_n(&self, START_NS + 99999999) == 4.0);
    CHECK(isnan(sensed_n(&self, START_NS + 100000000)));
    take_sample(&self, START_NS, 0);
    CHECK(self.row.measured_n == 4.0 && self.motion.measured_n == 4.0);
}

/* Paused, tripped, or not ready yet: the scene is not called and its force not sent. */
TEST(a_device_that_is_not_at_work_gets_no_force)
{
    const sp_period period = {.begin_ns = START_NS, .deadline_ns = START_NS - 100000};
    for (int why = 0; why < 3; why++) {
        for (int fresh = 0; fresh <= 1; fresh++) {
            between_ticks();
            self.paused = why == 0;
            self.tripped = why == 1;
            self.arming_ns = why == 2 ? START_NS : 0;
            device.ready = 0;
            self.row = (sp_row){.position_m = 0.75,
                                .velocity_mps = 3.0,
                                .returned_n = 99.0,
                                .notes = 8,
                                .tick_s = 1,
                                .call = 1};
            self.waiting[0] = sim.motion;
            self.waiting_count = 1;
            close_current_period(&self, &period, 0, fresh);
            CHECK(sim.calls == 0 && sim.writes == 1 && sim.written_n[0] == 0.0);
            CHECK(sp_loop_drain(&self, rows, 1) == 1);
            CHECK(call_of_row(0) == (SP_CALL_NONE | SP_CALL_SILENT));
            CHECK(rows[0].returned_n == 0.0 && rows[0].sent_n == 0.0);
            CHECK(rows[0].position_m == (fresh ? 0.25 : 0.75));
            CHECK(rows[0].velocity_mps == (fresh ? -0.125 : 3.0));
            CHECK(rows[0].notes == 0.0 && rows[0].tick_s == 0.0);
            CHECK(self.reason == 0 && self.idle_count == 0 && (int)self.stale == !fresh);
        }
    }
}

/* What the device says of a force: taken, no room, gone, tripped. */
TEST(a_force_that_was_not_taken_is_not_sent)
{
    const int gives[] = {0, 1, SP_LINK_GONE, SP_LINK_TRIPPED};
    for (unsigned i = 0; i < 4; i++) {
        int put = 9;
        between_ticks();
        sim.write_gives = gives[i];
        self.sent_n = 7.0;
        self.row.returned_n = 2.0;
        CHECK(send_force(&self, 0, &put) == 0 && put == gives[i] && sim.writes == 1);
        CHECK(self.sent_n == (gives[i] == 0 ? 2.0 : 7.0));
        CHECK((self.link == NULL) == (gives[i] == SP_LINK_GONE));
        CHECK((int)self.disconnects == (gives[i] == SP_LINK_GONE));
        CHECK(self.tripped == (gives[i] == SP_LINK_TRIPPED));
        CHECK((int)self.trips == (gives[i] == SP_LINK_TRIPPED));
    }
    int put = 9;
    between_ticks();
    CHECK(send_force(&self, 1, &put) == 0 && put == 1 && sim.writes == 0);
    self.link = NULL;
    put = 9;
    CHECK(send_force(&self, 0, &put) == 0 && put == 1 && sim.writes == 0);
    between_ticks();
    self.row.returned_n = 2.0;
    self.reason = SP_STOP_DEPTH;
    CHECK(send_force(&self, 0, &put) == 1 && put == 0 && sim.written_n[0] == 0.0);
}

TEST(a_force_has_the_sign_of_the_device_and_silence_releases_it)
{
    int put;
    between_ticks();
    self.config.reversed = 1;
    self.row.returned_n = 2.0;
    CHECK(send_force(&self, 0, &put) == 0 && sim.written_n[0] == -2.0 && self.sent_n == 2.0);
    CHECK(!device.released);
    self.latched = 1;
    CHECK(send_force(&self, 0, &put) == 0 && device.released);
    self.latched = 0;
    CHECK(send_force(&self, 0, &put) == 0 && !device.released);
    self.paused = 1;
    CHECK(send_force(&self, 0, &put) == 1 && device.released);
    device.released = 0;
    sp_loop_stop_device(&self);
    CHECK(device.released);
}

TEST(a_device_is_lost_at_work_or_at_zero)
{
    for (int at_zero = 0; at_zero < 4; at_zero++) {
        between_ticks();
        self.latched = at_zero & 1;
        self.tripped = at_zero >> 1;
        sp_loop_on_disconnect(&self);
        CHECK(self.tripped_before_disconnect == (at_zero != 0) && self.link == NULL);
    }
}

TEST(a_device_that_comes_back_is_taken_anew)
{
    for (int tripped_before = 0; tripped_before <= 1; tripped_before++) {
        for (int tripped = 0; tripped <= 1; tripped++) {
            between_ticks();
            self.link = NULL;
            self.connected = 0;
            self.tripped = tripped;
            self.tripped_before_disconnect = tripped_before;
            self.waiting_count = 3;
            self.motion.measured_n = 1.5;
            self.idle_count = 7;
            self.arming_ns = START_NS;
            sp_loop_attach(&self, &other);
            accept_requests(&self);
            CHECK(self.link == &other && self.connected == 1 && self.next_link == NULL);
            CHECK(self.tripped == (tripped && tripped_before));
            CHECK(self.reset_next == !tripped_before);
            CHECK(self.waiting_count == 0 && isnan(self.motion.measured_n));
            CHECK(self.idle_count == 0 && self.arming_ns == 0 && sim.device_resets == 0);
            self.link = &device;
            accept_requests(&self); /* once */
            CHECK(self.link == &device);
        }
    }
    between_ticks(); /* one that must be asked first */
    other.ready = 0;
    sim.makes_ready = 0;
    self.reset_next = 1;
    self.tripped_before_disconnect = 1;
    sp_loop_attach(&self, &other);
    accept_requests(&self);
    CHECK(sim.device_resets == 1 && self.arming_ns == START_NS && self.reset_next == 1);
    CHECK(!sp_loop_may_call_scene(&self));
    sim_now_ns += 1000000000;
    CHECK(!sp_loop_may_call_scene(&self) && !self.tripped);
    sim_now_ns += 1;
    CHECK(!sp_loop_may_call_scene(&self) && self.tripped && self.trips == 1);
}

TEST(a_reset_reaches_scene_and_device_once)
{
    between_ticks();
    self.tripped = 1;
    sp_loop_reset(&self);
    accept_requests(&self);
    CHECK(self.reset_next == 1 && self.tripped == 0 && sim.device_resets == 1);
    accept_requests(&self);
    CHECK(sim.device_resets == 1);
    between_ticks();
    self.link = NULL;
    sp_loop_reset(&self);
    accept_requests(&self);
    CHECK(self.reset_next == 1 && sim.device_resets == 0);
}

TEST(a_pause_ends_with_a_reset)
{
    between_ticks();
    sp_loop_pause(&self, 1);
    accept_requests(&self);
    CHECK(self.paused == 1 && self.reset_next == 0 && !sp_loop_may_call_scene(&self));
    accept_requests(&self);
    CHECK(self.paused == 1 && self.reset_next == 0);
    sp_loop_pause(&self, 0);
    accept_requests(&self);
    CHECK(self.paused == 0 && self.reset_next == 1 && sp_loop_may_call_scene(&self));
    self.reset_next = 0;
    accept_requests(&self);
    CHECK(self.reset_next == 0);
}

static void asks_for_all(int call)
{
    if (call == 10) {
        sp_loop_pause(&self, 1);
        sp_loop_request_stop(&self);
    }
}

static void asks_for_a_reset(int call)
{
    if (call == 10) {
        sp_loop_reset(&self);
    }
}

TEST(a_reset_that_is_asked_for_comes_before_the_next_call)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    begin_at_work();
    sim.in_call = asks_for_a_reset;
    CHECK(session(&config, &end) == 100 && end.resets == 1);
    CHECK(sim.resets == 1 && sim.device_resets == 1);
    CHECK(call_of_row(9) == 0 && call_of_row(10) == SP_CALL_RESET && call_of_row(11) == 0);
}

TEST(what_is_asked_is_heard_in_the_next_period)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    begin_at_work();
    sim.in_call = asks_for_all;
    CHECK(session(&config, &end) == 10 && end.reason == SP_STOP_ASKED && end.paused == 1);
}

/* Gone in a read, in a write, or when zero is sent at the end. */
static void leaves(int call)
{
    sim.read_gives = call >= 10 ? SP_LINK_GONE : 1;
}

static void trips(int call)
{
    sim.read_gives = call >= 10 ? SP_LINK_TRIPPED : 1;
}

TEST(a_device_that_leaves_or_trips_gets_nothing_more)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    begin_at_work();
    sim.in_call = leaves;
    CHECK(session(&config, &end) == 100 && end.disconnects == 1 && end.connected == 0);
    CHECK(sim.writes == 10 && sim.idles == 90 && end.stale == 90);
    CHECK(call_of_row(10) == (SP_CALL_IDLE | SP_CALL_UNSENT) && isnan(rows[10].measured_n));
    begin_at_work();
    sim.in_call = trips;
    CHECK(session(&config, &end) == 100 && end.tripped == 1 && end.watchdog_trips == 1);
    CHECK(sim.calls == 10 && sim.writes == 103 && sim.written_n[10] == 0.0);
    CHECK(call_of_row(10) == (SP_CALL_NONE | SP_CALL_SILENT));
    between_ticks();
    sim.write_gives = SP_LINK_GONE;
    sp_loop_stop_device(&self);
    CHECK(sim.writes == 1 && self.link == NULL && self.disconnects == 1 && !self.connected);
}

TEST(a_device_that_is_not_ready_is_asked_at_the_start)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    begin_at_work();
    (void)session(&config, &end);
    CHECK(sim.device_resets == 0);
    begin_at_work();
    device.ready = 0;
    CHECK(session(&config, &end) == 100 && sim.device_resets == 1 && sim.calls == 100);
}

/* However long there is no room for it: at most a fifth of a second. */
TEST(zero_is_sent_at_the_end_until_it_is_taken_three_times)
{
    for (uint64_t full_ms = 0; full_ms <= 300; full_ms++) {
        between_ticks();
        sim.full_until_ns = sim_now_ns + full_ms * 1000000u;
        sp_loop_stop_device(&self);
        const int waits = full_ms <= 200 ? (int)full_ms : 201;
        CHECK(sim.writes == waits + (full_ms <= 200 ? 3 : 0) && device.released);
        CHECK(sim_now_ns == START_NS + (full_ms <= 200 ? full_ms : 200) * 1000000u);
        for (int k = 0; k < sim.writes; k++) {
            CHECK(sim.written_n[k] == 0.0);
        }
    }
}
