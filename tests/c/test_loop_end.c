/* What ends a loop or silences it, one function at a time: no force where there must be none, and
 * the reason. Beside test_loop.c, which runs whole sessions. */
#define _GNU_SOURCE
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <string.h>
#include <time.h>

#include "check.h"

static int sim_clock(clockid_t clock, struct timespec *time);
static int sim_sleep(clockid_t clock, int flags, const struct timespec *until,
                     struct timespec *left);
static int sim_poll(struct pollfd *waits, nfds_t n, const struct timespec *left,
                    const sigset_t *mask);
#define clock_gettime sim_clock
#define clock_nanosleep sim_sleep
#define ppoll sim_poll
#define pthread_create(thread, attributes, run, argument) ((void)run(argument), 0)
#define pthread_join(thread, result) 0
#include "../../runtime_c/port/posix/sp_loop.c"
#include "../../runtime_c/port/posix/sp_loop_link.c"
#include "../../runtime_c/port/posix/sp_loop_sample.c"
#include "../../runtime_c/port/posix/sp_loop_tick.c"

enum { CAPACITY = 2048, LATCHED = 32, FD = 7 };
#define PERIOD_NS 1000000u
#define START_NS 5250000000u

/* The device, the scene and the clock. */
static struct {
    uint64_t now_ns;
    uint64_t late_ns, late_at_ns; /* the sleep that ends at late_at_ns or after ends so late */
    uint64_t poll_ns;             /* a sample comes so long after it is waited for; 0: at once */
    int polls, sleeps;
    int read_gives, reads; /* samples at once, or negative */
    uint32_t room;
    int placed;
    int write_gives, writes;
    double written_n[CAPACITY];
    int makes_ready, device_resets;
    sp_motion motion;
    int steps, idles, resets;
    int notes;
    double force_n, position_m, velocity_mps, measured_seen_n;
    double measured_n; /* where the scene finds what is measured */
    void (*in_call)(int call);
    int calls;
} sim;

static sp_loop self;
static sp_link device, other;
static sp_row ring[CAPACITY], rows[CAPACITY];

static int sim_clock(clockid_t clock, struct timespec *time)
{
    CHECK(clock == CLOCK_MONOTONIC);
    time->tv_sec = (time_t)(sim.now_ns / 1000000000u);
    time->tv_nsec = (long)(sim.now_ns % 1000000000u);
    return 0;
}

static uint64_t as_ns(const struct timespec *time)
{
    return (uint64_t)time->tv_sec * 1000000000u + (uint64_t)time->tv_nsec;
}

static int sim_sleep(clockid_t clock, int flags, const struct timespec *until,
                     struct timespec *left)
{
    CHECK(clock == CLOCK_MONOTONIC && flags == TIMER_ABSTIME && left == NULL);
    sim.sleeps++;
    sim.now_ns = as_ns(until);
    if (sim.late_ns > 0 && sim.now_ns >= sim.late_at_ns) {
        sim.now_ns += sim.late_ns;
        sim.late_ns = 0;
    }
    return 0;
}

static int sim_poll(struct pollfd *waits, nfds_t n, const struct timespec *left,
                    const sigset_t *mask)
{
    CHECK(n == 1 && waits->fd == self.link->fd && waits->events == POLLIN && mask == NULL);
    sim.polls++;
    if (sim.poll_ns <= as_ns(left)) {
        sim.now_ns += sim.poll_ns;
        return 1;
    }
    sim.now_ns += as_ns(left);
    return 0;
}

int32_t sp_realtime_ask(int32_t priority, int32_t cpu)
{
    return priority + cpu;
}

sp_motion *sp_link_place(sp_motion *motions, uint32_t capacity, int count)
{
    CHECK(capacity == WAITING);
    sim.placed++;
    return &motions[(uint32_t)count < capacity ? (uint32_t)count : capacity - 1];
}

static int read_sim(sp_link *link, uint64_t now_ns, sp_motion *motions, uint32_t capacity)
{
    (void)link;
    sim.reads++;
    sim.room = capacity;
    for (int i = 0; i < sim.read_gives && i < (int)capacity; i++) {
        motions[i] = sim.motion;
        motions[i].position_m += i;
        motions[i].arrived_ns = now_ns - 50000;
    }
    return sim.read_gives;
}

static int write_sim(sp_link *link, uint64_t now_ns, double force_n)
{
    (void)link;
    CHECK(now_ns == sim.now_ns);
    sim.written_n[sim.writes++ % CAPACITY] = force_n;
    return sim.write_gives;
}

static void reset_sim(sp_link *link, uint64_t now_ns)
{
    CHECK(now_ns == sim.now_ns);
    sim.device_resets++;
    link->ready = sim.makes_ready;
}

static int called(sp_real *force_n)
{
    *force_n = (sp_real)sim.force_n;
    sim.now_ns += 250000;
    sim.calls++;
    if (sim.in_call != NULL) {
        sim.in_call(sim.calls);
    }
    return sim.notes;
}

static int step(void *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n)
{
    CHECK(state == &sim);
    sim.steps++;
    sim.position_m = (double)position_m;
    sim.velocity_mps = (double)velocity_mps;
    sim.measured_seen_n = sim.measured_n;
    return called(force_n);
}

static int idle(void *state, sp_real dt_s, sp_real *force_n)
{
    CHECK(state == &sim && dt_s == (sp_real)1e-3);
    sim.idles++;
    if (sim.notes < 0) { /* refused: what is there stays */
        sim.calls++;
        return sim.notes;
    }
    return called(force_n);
}

static void reset(void *state)
{
    CHECK(state == &sim);
    sim.resets++;
}

static sp_loop_config usual(void)
{
    sp_loop_config config = {.state = &sim,
                             .measured_n = &sim.measured_n,
                             .period_s = 1e-3,
                             .seconds = 0.1,
                             .max_force_n = 10.0,
                             .max_depth_m = 0.5,
                             .latched_note = LATCHED,
                             .priority = 40,
                             .cpu = 2,
                             .rows = ring,
                             .capacity = CAPACITY};
    int (*const steps)(void *, sp_real, sp_real, sp_real *) = step;
    int (*const idles)(void *, sp_real, sp_real *) = idle;
    void (*const resets)(void *) = reset;
    memcpy(&config.step, &steps, sizeof config.step);
    memcpy(&config.idle, &idles, sizeof config.idle);
    memcpy(&config.reset, &resets, sizeof config.reset);
    return config;
}

static void begin_at_work(void)
{
    memset(&sim, 0, sizeof sim);
    sim.now_ns = START_NS;
    sim.makes_ready = 1;
    sim.read_gives = 1;
    sim.force_n = 2.0;
    sim.motion = (sp_motion){.position_m = 0.25, .velocity_mps = -0.125, .measured_n = 1.5};
    device =
        (sp_link){.fd = -1, .ready = 1, .read = read_sim, .write = write_sim, .reset = reset_sim};
    other = device;
}

/* A loop as it is between two ticks. */
static void between_ticks(void)
{
    begin_at_work();
    memset(&self, 0, sizeof self);
    self.config = usual();
    memcpy(&self.step, &self.config.step, sizeof self.step);
    memcpy(&self.idle, &self.config.idle, sizeof self.idle);
    memcpy(&self.reset, &self.config.reset, sizeof self.reset);
    self.ring.rows = ring;
    self.ring.mask = CAPACITY - 1;
    self.period_ns = PERIOD_NS;
    self.max_owed = 2;
    self.link = &device;
    self.connected = 1;
    self.start_ns = START_NS - 10 * PERIOD_NS;
    self.deadline_ns = START_NS - 100000;
    self.end_ns = UINT64_MAX;
}

/* A whole session; the count of its rows. */
static uint32_t session(const sp_loop_config *config, sp_loop_state *end)
{
    memset(&self, 0x55, sizeof self);
    CHECK(sp_loop_start(&self, config, &device) == 0);
    sp_loop_get_status(&self, end);
    return sp_loop_drain(&self, rows, CAPACITY);
}

static int call_of_row(uint32_t row)
{
    return (int)rows[row].call;
}

static int is_near(double a, double b)
{
    return fabs(a - b) < 1e-12;
}

static void a_row_says_when_and_with_what_the_scene_was_called(void)
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
    CHECK(self.max_owed == 2 && sp_loop_size() == sizeof(sp_loop));
}

static void a_thread_that_is_a_period_late_sends_no_old_force(void)
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
static void each_limit_ends_it_with_no_force(void)
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
        sp_loop_ask_stop(&self);
    }
}

static void without_a_time_it_runs_until_it_is_asked(void)
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

static void the_end_of_a_replay_ends_it(void)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    begin_at_work();
    sim.in_call = replay_ends;
    CHECK(session(&config, &end) == 20 && end.reason == SP_STOP_ENDED);
    CHECK(sim.writes == 23 && sim.written_n[20] == 0.0 && sim.idles == 0);
    CHECK(is_near(end.elapsed_s, 0.01925));
    between_ticks();
    sim.read_gives = SP_LINK_ENDED;
    self.reason = SP_STOP_FORCE; /* the first reason counts */
    take(&self);
    CHECK(self.reason == SP_STOP_FORCE);
}

static void latches(int call)
{
    sim.notes = (call >= 9 && call <= 11) || call == 20 ? LATCHED | 1 : 1;
}

static void each_trip_of_the_watchdog_is_counted_once(void)
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
        call_of(&self, &period, START_NS, 0);
        CHECK(self.latched == cases[i].latched && (int)self.trips == cases[i].latched);
        CHECK(self.row.notes == cases[i].notes);
    }
}

static void idle_takes_the_last_force_where_the_scene_gives_none(void)
{
    const sp_period period = {.begin_ns = START_NS};
    between_ticks();
    self.row.returned_n = 3.0;
    sim.notes = -1;
    call_of(&self, &period, START_NS, 0);
    CHECK(self.row.returned_n == 3.0 && self.reason == SP_STOP_MISUSE);
    CHECK(isnan(self.row.age_s));
}

static void a_reset_comes_before_one_call(void)
{
    for (int fresh = 0; fresh <= 1; fresh++) {
        const sp_period period = {.begin_ns = START_NS};
        between_ticks();
        self.waiting_count = 1;
        self.reset_next = 1;
        call_of(&self, &period, START_NS, fresh);
        CHECK(sim.resets == 1 && self.resets == 1 && self.reset_next == 0);
        CHECK((int)self.row.call == (SP_CALL_RESET | (fresh ? 0 : SP_CALL_IDLE)));
        self.waiting_count = 1;
        call_of(&self, &period, START_NS, fresh);
        CHECK(sim.resets == 1 && (int)self.row.call == (fresh ? 0 : SP_CALL_IDLE));
    }
}

static void what_a_device_that_is_gone_measured_is_not_measured(void)
{
    const sp_period period = {.begin_ns = START_NS};
    between_ticks();
    self.motion.measured_n = 1.5;
    call_of(&self, &period, START_NS, 0);
    CHECK(self.row.measured_n == 1.5); /* one lost sample */
    self.link = NULL;
    call_of(&self, &period, START_NS, 0);
    CHECK(isnan(self.row.measured_n) && isnan(self.motion.measured_n));
}

/* Paused, tripped, or not ready yet: the scene is not called and its force not sent. */
static void a_device_that_is_not_at_work_gets_no_force(void)
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
            settle_current(&self, &period, 0, fresh);
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

static void what_is_not_at_work_is_not_limited(void)
{
    between_ticks();
    self.row.position_m = 99.0;
    self.row.measured_n = (double)NAN;
    self.paused = 1;
    check_limits(&self);
    CHECK(self.reason == 0);
    self.paused = 0;
    check_limits(&self);
    CHECK(self.reason == SP_STOP_DEPTH);
    self.row.returned_n = 99.0;
    check_limits(&self);
    CHECK(self.reason == SP_STOP_DEPTH); /* the first reason counts */
}

/* What the device says of a force: taken, no room, gone, tripped. */
static void a_force_that_was_not_taken_is_not_sent(void)
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

static void rows_count_what_was_late_or_without_a_sample(void)
{
    between_ticks();
    sp_period period = {.deadline_ns = START_NS};
    const struct {
        uint64_t after_ns;
        int fresh;
    } cases[] = {{0, 1}, {PERIOD_NS, 0}, {PERIOD_NS + 1, 0}, {3 * PERIOD_NS, 1}};
    for (unsigned i = 0; i < 4; i++) {
        period.begin_ns = START_NS + cases[i].after_ns;
        put_row(&self, &period, 4.0, SP_CALL_UNSENT, cases[i].fresh);
    }
    CHECK(self.late == 2 && self.stale == 2 && self.ticks == 4);
    CHECK(sp_loop_drain(&self, rows, 9) == 4);
    CHECK(rows[3].sent_n == 4.0 && call_of_row(3) == SP_CALL_UNSENT);
}

/* A period that was open when its limit was met: zero goes out at once. */
static void an_open_period_that_meets_a_limit_ends_it(void)
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
        settle_owed(&self, &open, START_NS, fresh);
        CHECK(self.reason == SP_STOP_FORCE && sim.writes == 1 && sim.written_n[0] == 0.0);
        CHECK(sp_loop_drain(&self, rows, 9) == 1 && rows[0].sent_n == (unsent ? 7.0 : 0.0));
        CHECK(call_of_row(0) ==
              (SP_CALL_SILENT | (fresh ? 0 : SP_CALL_IDLE) | (unsent ? SP_CALL_UNSENT : 0)));
    }
    between_ticks();
    const sp_period open = {.begin_ns = START_NS, .deadline_ns = START_NS, .sent_n = 1.0};
    settle_owed(&self, &open, START_NS, 0);
    CHECK(self.reason == 0 && sim.writes == 0);
    CHECK(sp_loop_drain(&self, rows, 9) == 1 && rows[0].sent_n == 1.0);
    CHECK(call_of_row(0) == (SP_CALL_IDLE | SP_CALL_UNSENT));
}

static void a_period_stays_open_only_where_its_sample_may_come(void)
{
    between_ticks();
    CHECK(!may_owe(&self)); /* a sample is there whenever it is asked for */
    device.fd = 0;
    CHECK(may_owe(&self));
    self.reset_next = 1;
    CHECK(!may_owe(&self));
    self.reset_next = 0;
    self.paused = 1;
    CHECK(!may_owe(&self));
    self.paused = 0;
    self.link = NULL;
    CHECK(!may_owe(&self));
}

/* Twenty without a sample among the last hundred; of a silence, six. */
static void too_few_samples_are_counted_in_the_last_hundred(void)
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
    CHECK(self.idle_count == 20 && self.watched_at == 39); /* the last was not looked at */

    for (int why = 0; why < 3; why++) { /* nothing is counted */
        between_ticks();
        self.link = why == 0 ? NULL : &device;
        self.paused = why == 1;
        self.reason = why == 2 ? SP_STOP_DEPTH : 0;
        self.row.call = SP_CALL_IDLE;
        check_rate(&self);
        CHECK(self.idle_count == 0 && self.idle_run == 0 && self.watched_at == 0);
    }
}

static void samples_that_came_too_late_forgive_the_newest_calls(void)
{
    for (int at = 0; at < WATCHED; at += 33) {
        between_ticks();
        self.watched_at = at;
        memset(self.was_idle, 1, sizeof self.was_idle);
        self.idle_count = WATCHED;
        self.was_idle[(at + WATCHED - 2) % WATCHED] = 0;
        self.idle_count--;
        sp_loop_forgive(&self, 2);
        CHECK(self.idle_count == WATCHED - 3);
        for (int back = 1; back <= WATCHED; back++) {
            CHECK(self.was_idle[(at + WATCHED - back) % WATCHED] == (back > 3));
        }
        sp_loop_forgive(&self, 0);
        CHECK(self.idle_count == WATCHED - 3);
        sp_loop_forgive(&self, 1000); /* more than there are */
        CHECK(self.idle_count == 0);
    }
    between_ticks();
    memset(self.was_idle, 1, sizeof self.was_idle);
    self.idle_count = 7;
    self.idle_run = 3;
    sp_loop_watch_anew(&self);
    CHECK(self.idle_count == 0 && self.idle_run == 0);
    CHECK(self.was_idle[0] == 0 && self.was_idle[WATCHED - 1] == 0);
}

static void a_device_that_comes_back_is_taken_anew(void)
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
    CHECK(!sp_loop_at_work(&self));
    sim.now_ns += 1000000000;
    CHECK(!sp_loop_at_work(&self) && !self.tripped);
    sim.now_ns += 1;
    CHECK(!sp_loop_at_work(&self) && self.tripped && self.trips == 1);
}

static void a_reset_reaches_scene_and_device_once(void)
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

static void a_pause_ends_with_a_reset(void)
{
    between_ticks();
    sp_loop_pause(&self, 1);
    accept_requests(&self);
    CHECK(self.paused == 1 && self.reset_next == 0 && !sp_loop_at_work(&self));
    accept_requests(&self);
    CHECK(self.paused == 1 && self.reset_next == 0);
    sp_loop_pause(&self, 0);
    accept_requests(&self);
    CHECK(self.paused == 0 && self.reset_next == 1 && sp_loop_at_work(&self));
    self.reset_next = 0;
    accept_requests(&self);
    CHECK(self.reset_next == 0);
}

static void asks_for_all(int call)
{
    if (call == 10) {
        sp_loop_pause(&self, 1);
        sp_loop_ask_stop(&self);
    }
}

static void asks_for_a_reset(int call)
{
    if (call == 10) {
        sp_loop_reset(&self);
    }
}

static void asks_in_a_silence(int call)
{
    if (call == 10) {
        sp_loop_ask_stop(&self);
    }
}

static void a_reset_that_is_asked_for_comes_before_the_next_call(void)
{
    sp_loop_state end;
    const sp_loop_config config = usual();
    begin_at_work();
    sim.in_call = asks_for_a_reset;
    CHECK(session(&config, &end) == 100 && end.resets == 1);
    CHECK(sim.resets == 1 && sim.device_resets == 1);
    CHECK(call_of_row(9) == 0 && call_of_row(10) == SP_CALL_RESET && call_of_row(11) == 0);
}

/* No sample at all: deadlines stay where they are, and open periods get their rows at the end. */
static void a_device_that_never_sends_has_all_its_rows(void)
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
static void a_session_follows_the_clock_of_the_device(void)
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

static void a_tick_says_whether_there_was_a_sample(void)
{
    between_ticks();
    self.waiting_count = 1;
    CHECK(sp_loop_tick(&self, 0) == 1 && sim.steps == 1 && self.owed_count == 0);
    CHECK(sp_loop_tick(&self, 0) == 0 && sim.idles == 1 && self.owed_count == 0);
    device.fd = FD;
    CHECK(sp_loop_tick(&self, 0) == 0 && sim.idles == 1 && self.owed_count == 1);
}

static void what_is_asked_is_heard_in_the_next_period(void)
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

static void a_device_that_leaves_or_trips_gets_nothing_more(void)
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
    stop_device(&self);
    CHECK(sim.writes == 1 && self.link == NULL && self.disconnects == 1 && !self.connected);
}

static void a_device_that_is_not_ready_is_asked_at_the_start(void)
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

/* The first sample may be old; the one after it is not. */
static void the_first_deadline_follows_the_second_sample(void)
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

static void deadlines_follow_the_clock_of_the_device_little_by_little(void)
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

static void periods_stay_open_for_two_ms_and_one_at_least(void)
{
    const struct {
        double rate_hz;
        int owed;
    } cases[] = {{100, 1},  {400, 1},   {999, 1},   {1000, 2},  {1500, 2},
                 {2000, 4}, {8000, 16}, {8500, 16}, {20000, 16}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_loop_state end;
        sp_loop_config config = usual();
        config.period_s = 1.0 / cases[i].rate_hz;
        config.seconds = 1e-9;
        begin_at_work();
        (void)session(&config, &end);
        CHECK(self.max_owed == cases[i].owed);
        CHECK(fabs((double)self.period_ns - 1e9 / cases[i].rate_hz) <= 0.5);
    }
}

static void all_that_waits_is_read_and_kept_in_order(void)
{
    between_ticks();
    sim.read_gives = 3;
    take(&self);
    CHECK(sim.room == WAITING && self.waiting_count == 3 && self.waiting[2].position_m == 2.25);
    sim.read_gives = WAITING;
    take(&self);
    CHECK(self.waiting_count == WAITING);
    sim.read_gives = 0;
    take(&self);
    CHECK(self.waiting_count == WAITING && self.reason == 0 && self.link == &device);
    sp_loop_use(&self, WAITING - 2);
    CHECK(self.waiting_count == 2);
    sim.read_gives = WAITING + 5; /* more than there was room for: the newest of them are here */
    sim.placed = 0;
    take(&self);
    CHECK(sim.placed == WAITING && self.waiting_count == WAITING);
    struct timespec time = as_timespec(5250000000u);
    CHECK(time.tv_sec == 5 && time.tv_nsec == 250000000);
    time = as_timespec(4999999999u);
    CHECK(time.tv_sec == 4 && time.tv_nsec == 999999999);
}

static void samples_are_looked_for_where_and_as_long_as_they_help(void)
{
    const struct {
        int fd, waiting, owed;
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
        self.owed_count = cases[i].owed;
        self.idle_count = 5;
        memset(self.was_idle, 1, 5);
        self.watched_at = 5;
        sp_loop_look_for_samples(&self, cases[i].late_ns);
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
        sim.now_ns = self.deadline_ns;
        sp_loop_look_for_samples(&self, late ? PERIOD_NS : PERIOD_NS - 1);
        CHECK(sim.polls == !late && sim.reads == 1);
        CHECK(sim.now_ns == self.deadline_ns + (late ? 0 : PERIOD_NS / 4));
    }
    between_ticks();
    self.link = NULL;
    sp_loop_look_for_samples(&self, 0);
    CHECK(sim.reads == 0 && sim.sleeps == 0);
}

static void a_device_without_a_descriptor_is_not_waited_for(void)
{
    for (int gone = 0; gone <= 1; gone++) {
        between_ticks();
        self.link = gone ? NULL : &device;
        sp_loop_listen(&self, START_NS + 300000, 0);
        CHECK(sim.sleeps == 1 && sim.polls == 0 && sim.now_ns == START_NS + 300000);
    }
    between_ticks();
    device.fd = 0;
    sim.poll_ns = 100000;
    sp_loop_listen(&self, START_NS + 300000, 2);
    CHECK(sim.sleeps == 0 && sim.polls == 2 && self.waiting_count == 2);
    sim.poll_ns = 400000;
    sp_loop_listen(&self, START_NS + 300000, 0);
    CHECK(sim.polls == 3 && self.waiting_count == 2 && sim.now_ns == START_NS + 300000);
}

static void the_status_is_that_of_the_loop(void)
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
    CHECK(state.ticks == 1 && state.late == 2 && state.stale == 3 && state.unused == 4);
    CHECK(state.ring_dropped == 5 && state.watchdog_trips == 6 && state.disconnects == 7);
    CHECK(state.resets == 8 && state.newest_row == 9 && is_near(state.elapsed_s, 1.5));
    CHECK(state.latched == 11 && state.tripped == 12 && state.tripped_before_disconnect == 13);
    CHECK(state.connected == 14 && state.paused == 15 && state.reason == 16);
    CHECK(state.over == 17 && state.got == 18);
}

static void the_open_periods_move_up(void)
{
    between_ticks();
    device.fd = FD;
    for (int i = 0; i < 3; i++) {
        self.owed[i] = (sp_period){.begin_ns = START_NS, .deadline_ns = START_NS, .sent_n = i + 1};
    }
    self.owed_count = 3;
    self.waiting_count = 1;
    settle(&self, 1, 0, START_NS);
    CHECK(self.owed_count == 2 && self.owed[0].sent_n == 2.0 && self.owed[1].sent_n == 3.0);
    CHECK(sp_loop_drain(&self, rows, 9) == 1 && rows[0].sent_n == 1.0 && sim.steps == 1);
    sp_loop_settle(&self);
    CHECK(self.owed_count == 0 && sim.idles == 2);
    CHECK(sp_loop_drain(&self, rows, 9) == 2 && rows[1].sent_n == 3.0);
}

int main(void)
{
    a_row_says_when_and_with_what_the_scene_was_called();
    a_thread_that_is_a_period_late_sends_no_old_force();
    each_limit_ends_it_with_no_force();
    without_a_time_it_runs_until_it_is_asked();
    the_end_of_a_replay_ends_it();
    each_trip_of_the_watchdog_is_counted_once();
    idle_takes_the_last_force_where_the_scene_gives_none();
    a_reset_comes_before_one_call();
    what_a_device_that_is_gone_measured_is_not_measured();
    a_device_that_is_not_at_work_gets_no_force();
    what_is_not_at_work_is_not_limited();
    a_force_that_was_not_taken_is_not_sent();
    rows_count_what_was_late_or_without_a_sample();
    an_open_period_that_meets_a_limit_ends_it();
    a_period_stays_open_only_where_its_sample_may_come();
    too_few_samples_are_counted_in_the_last_hundred();
    samples_that_came_too_late_forgive_the_newest_calls();
    a_device_that_comes_back_is_taken_anew();
    a_reset_reaches_scene_and_device_once();
    a_pause_ends_with_a_reset();
    a_reset_that_is_asked_for_comes_before_the_next_call();
    a_device_that_never_sends_has_all_its_rows();
    a_session_follows_the_clock_of_the_device();
    a_tick_says_whether_there_was_a_sample();
    what_is_asked_is_heard_in_the_next_period();
    a_device_that_leaves_or_trips_gets_nothing_more();
    a_device_that_is_not_ready_is_asked_at_the_start();
    the_first_deadline_follows_the_second_sample();
    deadlines_follow_the_clock_of_the_device_little_by_little();
    periods_stay_open_for_two_ms_and_one_at_least();
    all_that_waits_is_read_and_kept_in_order();
    samples_are_looked_for_where_and_as_long_as_they_help();
    a_device_without_a_descriptor_is_not_waited_for();
    the_status_is_that_of_the_loop();
    the_open_periods_move_up();
    return failed;
}
