/* A session on a simulated clock: device, scene and loop do what `sim` says, and count. */
#ifndef SIMULATED_SESSION_H
#define SIMULATED_SESSION_H

#include "simulated_clock.h"

enum { CAPACITY = 2048, LATCHED = 32, FD = 7, LOST = -1 };
#define PERIOD_NS 1000000u
#define START_NS 5250000000u

/* The device, the scene and the clock. */
static struct {
    uint64_t late_ns, late_at_ns; /* the sleep that ends at late_at_ns or after ends so late */
    uint64_t poll_ns;             /* a sample comes so long after it is waited for; 0: at once */
    int polls, sleeps;
    int read_gives, reads; /* samples at once, or negative */
    uint32_t room;
    int placed;
    int write_gives, writes;
    uint64_t full_until_ns; /* until then a write finds no room */
    double written_n[CAPACITY];
    int makes_ready, device_resets;
    sp_motion motion;
    int steps, idles, resets;
    int notes;
    double force_n, position_m, velocity_mps, measured_seen_n;
    double measured_n; /* where the scene finds what is measured */
    void (*in_call)(int call);
    int calls, joins;
    uint64_t call_ns; /* how long the scene takes */
    /* Where there are any: sample k comes then, in order, and says position k - 1; the scene gives
     * one more. LOST ones never come. */
    const int64_t *arrivals_us;
    int count, at;
} sim;

static sp_loop self;
static sp_link device, other;
static sp_row ring[CAPACITY], rows[CAPACITY];

static int sim_sleep(clockid_t clock, int flags, const struct timespec *until,
                     struct timespec *left)
{
    CHECK(clock == CLOCK_MONOTONIC && flags == TIMER_ABSTIME && left == NULL);
    sim.sleeps++;
    sim_now_ns = as_ns(until);
    if (sim.late_ns > 0 && sim_now_ns >= sim.late_at_ns) {
        sim_now_ns += sim.late_ns;
        sim.late_ns = 0;
    }
    return 0;
}

static int sim_join(void)
{
    sim.joins++;
    return 0;
}

/* Whether a sample comes by then. */
static int arrives_by(uint64_t until_ns)
{
    while (sim.at < sim.count && sim.arrivals_us[sim.at] == LOST) {
        sim.at++;
    }
    return sim.at < sim.count && 1000u * (uint64_t)sim.arrivals_us[sim.at] <= until_ns;
}

int sp_link_wait(int fd, uint64_t max_ns)
{
    CHECK(fd == self.link->fd);
    sim.polls++;
    if (sim.arrivals_us != NULL) {
        const uint64_t until_ns = sim_now_ns + max_ns;
        const int comes = arrives_by(until_ns);
        const uint64_t then_ns = comes ? 1000u * (uint64_t)sim.arrivals_us[sim.at] : until_ns;
        sim_now_ns = then_ns > sim_now_ns ? then_ns : sim_now_ns;
        return comes;
    }
    if (sim.poll_ns <= max_ns) {
        sim_now_ns += sim.poll_ns;
        return 1;
    }
    sim_now_ns += max_ns;
    return 0;
}

sp_motion *sp_link_next_slot(sp_motion *motions, uint32_t capacity, int count)
{
    CHECK(capacity == MAX_WAITING);
    sim.placed++;
    return &motions[(uint32_t)count < capacity ? (uint32_t)count : capacity - 1];
}

static int read_sim(sp_link *link, uint64_t now_ns, sp_motion *motions, uint32_t capacity)
{
    int count = 0;
    sim.reads++;
    sim.room = capacity;
    while (sim.arrivals_us != NULL && arrives_by(now_ns)) {
        motions[count++] = (sp_motion){
            .position_m = sim.at++ - 1, .measured_n = (double)NAN, .arrived_ns = now_ns};
        link->samples++;
    }
    if (sim.arrivals_us != NULL) {
        return count;
    }
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
    CHECK(now_ns == sim_now_ns);
    sim.written_n[sim.writes++ % CAPACITY] = force_n;
    return now_ns < sim.full_until_ns ? 1 : sim.write_gives;
}

static void reset_sim(sp_link *link, uint64_t now_ns)
{
    CHECK(now_ns == sim_now_ns);
    sim.device_resets++;
    link->ready = sim.makes_ready;
}

static int called(sp_real *force_n)
{
    *force_n = (sp_real)sim.force_n;
    sim_now_ns += sim.call_ns;
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
    sim.force_n = sim.arrivals_us != NULL ? (double)position_m + 1.0 : sim.force_n;
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

static inline sp_loop_config usual(void)
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

static inline void begin_at_work(void)
{
    memset(&sim, 0, sizeof sim);
    sim_now_ns = START_NS;
    sim.makes_ready = 1;
    sim.read_gives = 1;
    sim.force_n = 2.0;
    sim.call_ns = 250000;
    sim.motion = (sp_motion){.position_m = 0.25, .velocity_mps = -0.125, .measured_n = 1.5};
    device =
        (sp_link){.fd = -1, .ready = 1, .read = read_sim, .write = write_sim, .reset = reset_sim};
    other = device;
}

/* A loop as it is between two ticks. */
static inline void between_ticks(void)
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
    self.max_open = 2;
    self.link = &device;
    self.connected = 1;
    self.start_ns = START_NS - 10 * PERIOD_NS;
    self.deadline_ns = START_NS - 100000;
    self.end_ns = UINT64_MAX;
}

/* A whole session; the count of its rows. */
static inline uint32_t session(const sp_loop_config *config, sp_loop_state *end)
{
    memset(&self, 0x55, sizeof self);
    CHECK(sp_loop_start(&self, config, &device) == 0);
    sp_loop_get_status(&self, end);
    return sp_loop_drain(&self, rows, CAPACITY);
}

static inline int call_of_row(uint32_t row)
{
    return (int)rows[row].call;
}

static inline int is_near(double a, double b)
{
    return fabs(a - b) < 1e-12;
}

#endif
