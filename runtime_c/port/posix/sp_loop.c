#define _GNU_SOURCE
#include "sp_loop.h"

#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <string.h>
#include <time.h>

#include "sp_realtime.h"
#include "sp_ring.h"

typedef int (*step_function)(void *, sp_real, sp_real, sp_real *);
typedef int (*idle_function)(void *, sp_real, sp_real *);
typedef void (*reset_function)(void *);

enum { WAITING = 64 };

struct sp_loop {
    sp_loop_config config;
    step_function step;
    idle_function idle;
    reset_function reset;
    pthread_t thread;
    sp_ring ring;

    /* Asked by the other thread. */
    _Atomic int want_stop;
    _Atomic int want_pause;
    _Atomic int want_reset;
    _Atomic(sp_link *) next_link;

    /* Told to the other thread, under no lock: each by itself. */
    _Atomic uint64_t ticks, late, stale, trips, disconnects, resets, elapsed_ns;
    _Atomic int connected, latched, tripped, kept_trip, paused, reason, over, got;

    /* The thread's own. */
    sp_link *link;
    sp_motion motion;           /* of this tick */
    sp_motion waiting[WAITING]; /* samples that no tick has used, oldest first */
    int waiting_count;
    uint64_t period_ns, start_ns, deadline_ns, end_ns;
    int fresh;          /* a sample came that no tick has used */
    int reset_next;     /* the scene, before its next call */
    uint64_t arming_ns; /* since when the device was asked to be ready; 0: it is */
    sp_row row;
};

static const uint64_t first_sample_ns = 200000000; /* longest wait for it before the first tick */
static const uint64_t most_arming_ns = 1000000000;

static uint64_t now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

static struct timespec as_timespec(uint64_t time_ns)
{
    return (struct timespec){.tv_sec = (time_t)(time_ns / 1000000000u),
                             .tv_nsec = (long)(time_ns % 1000000000u)};
}

static void lose_link(sp_loop *self)
{
    self->link = NULL;
    self->kept_trip = self->latched || self->tripped;
    self->connected = 0;
    self->disconnects++;
}

static void trip(sp_loop *self)
{
    if (!self->tripped) {
        self->tripped = 1;
        self->trips++;
    }
}

static void make_ready(sp_loop *self)
{
    self->link->reset(self->link, now());
    self->arming_ns = self->link->ready ? 0 : now();
}

/* Whether the scene may be called: no force reaches a device that is not ready. */
static int at_work(sp_loop *self)
{
    if (self->arming_ns && self->link != NULL) {
        if (self->link->ready) {
            self->arming_ns = 0;
        } else if (now() - self->arming_ns > most_arming_ns) {
            self->arming_ns = 0;
            trip(self);
        }
    }
    return !self->paused && !self->tripped && !self->arming_ns;
}

static void take(sp_loop *self)
{
    sp_motion come[WAITING];
    const int count = self->link->read(self->link, now(), come, WAITING);
    if (count > 0) {
        for (int i = 0; i < count && i < WAITING; i++) {
            *sp_link_place(self->waiting, WAITING, self->waiting_count) = come[i];
            self->waiting_count += self->waiting_count < WAITING;
        }
    } else if (count == SP_LINK_GONE) {
        lose_link(self);
    } else if (count == SP_LINK_TRIPPED) {
        trip(self);
    } else if (count == SP_LINK_ENDED && !self->reason) {
        self->reason = SP_STOP_ENDED;
    }
}

/* Read what comes until a time, or only until a sample came. */
static void listen_until(sp_loop *self, uint64_t until_ns, int only_first)
{
    uint64_t time_ns;
    while ((time_ns = now()) < until_ns && !(only_first && self->waiting_count)) {
        if (self->link == NULL || self->link->fd < 0) {
            const struct timespec until = as_timespec(until_ns);
            (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
            continue;
        }
        const struct timespec left = as_timespec(until_ns - time_ns);
        struct pollfd waits = {.fd = self->link->fd, .events = POLLIN};
        if (ppoll(&waits, 1, &left, NULL) > 0) {
            take(self);
        }
    }
}

static void look_for_sample(sp_loop *self, int behind)
{
    if (self->link != NULL && !self->waiting_count) {
        take(self);
    }
    /* A sample that is a little late is worth waiting for, while the tick itself is in time. */
    if (self->link != NULL && self->link->fd >= 0 && !behind) {
        listen_until(self, self->deadline_ns + self->period_ns / 4, 1);
    }
}

/* The sample of this tick: the newest. Periods that were missed take one each, oldest first, so
 * that the scene's memory has no hole. Returns whether there is one. */
static int next_sample(sp_loop *self, int behind)
{
    if (!self->waiting_count) {
        return 0;
    }
    const int used = behind ? 1 : self->waiting_count;
    self->motion = self->waiting[used - 1];
    self->waiting_count -= used;
    memmove(self->waiting, self->waiting + used,
            (size_t)self->waiting_count * sizeof *self->waiting);
    return 1;
}

static void begin_row(sp_loop *self, uint64_t begin_ns)
{
    sp_row *row = &self->row;
    row->time_s = 1e-9 * (double)(int64_t)(begin_ns - self->start_ns);
    row->lateness_s = 1e-9 * (double)(int64_t)(begin_ns - self->deadline_ns);
    row->dt_s = (double)(sp_real)self->config.period_s;
    row->call = 0;
    row->notes = 0;
    row->tick_s = 0;
    row->measured_n = self->motion.measured_n;
}

static void accept_wishes(sp_loop *self)
{
    sp_link *next = atomic_exchange(&self->next_link, NULL);
    if (next != NULL) {
        self->link = next;
        self->tripped = self->tripped && self->kept_trip;
        self->reset_next = self->reset_next || !self->kept_trip;
        self->connected = 1;
        self->waiting_count = 0;
        self->arming_ns = 0;
        if (!next->ready) {
            make_ready(self);
        }
    }
    if (atomic_exchange(&self->want_reset, 0)) {
        self->reset_next = 1;
        self->tripped = 0;
        if (self->link != NULL) {
            make_ready(self);
        }
    }
    const int pause = self->want_pause;
    if (self->paused && !pause) {
        self->reset_next = 1;
    }
    self->paused = pause;
}

/* The scene's call of this period. */
static void call_scene(sp_loop *self, int fresh)
{
    sp_row *row = &self->row;
    sp_real force_n = (sp_real)row->returned_n;
    int call = 0, notes;
    if (self->reset_next) {
        self->reset(self->config.state);
        self->reset_next = 0;
        self->resets++;
        call |= SP_CALL_RESET;
    }
    const uint64_t begin_ns = now();
    if (fresh) {
        const sp_real position_m = (sp_real)self->motion.position_m;
        const sp_real velocity_mps = (sp_real)self->motion.velocity_mps;
        if (self->config.measured_n != NULL) {
            *self->config.measured_n = self->motion.measured_n;
        }
        notes = self->step(self->config.state, position_m, velocity_mps, &force_n);
        row->position_m = (double)position_m;
        row->velocity_mps = (double)velocity_mps;
    } else {
        call |= SP_CALL_IDLE;
        notes = self->idle(self->config.state, (sp_real)self->config.period_s, &force_n);
    }
    row->tick_s = 1e-9 * (double)(now() - begin_ns);
    row->call = call;
    row->notes = notes;
    row->returned_n = (double)force_n;
    const int latched = notes >= 0 && (notes & self->config.latched_note);
    self->trips += latched && !self->latched;
    self->latched = latched;
    if (notes < 0) {
        self->reason = SP_STOP_MISUSE;
    }
}

static void check_limits(sp_loop *self)
{
    const sp_row *row = &self->row;
    const double measured_n = isfinite(row->measured_n) ? row->measured_n : 0.0;
    if (self->reason || !at_work(self)) {
        return;
    }
    if (!(fabs(row->returned_n) <= self->config.max_force_n) ||
        !(fabs(measured_n) <= self->config.max_force_n)) {
        self->reason = SP_STOP_FORCE;
    } else if (row->position_m > self->config.max_depth_m) {
        self->reason = SP_STOP_DEPTH;
    }
}

static void send_force(sp_loop *self, int behind)
{
    sp_row *row = &self->row;
    int call = (int)row->call;
    double force_n = row->returned_n;
    if (self->reason || !at_work(self)) {
        force_n = 0.0;
        call |= SP_CALL_SILENT;
    }
    int put = 1;
    if (self->link != NULL && !behind) {
        put = self->link->write(self->link, now(), force_n);
        if (put == SP_LINK_GONE) {
            lose_link(self);
        } else if (put == SP_LINK_TRIPPED) {
            trip(self);
        }
    }
    if (put == 0) {
        row->sent_n = force_n;
    } else {
        call |= SP_CALL_UNSENT;
    }
    row->call = call;
}

/* One period. behind: the next one has begun too. */
static void tick(sp_loop *self, uint64_t begin_ns, int fresh, int behind)
{
    begin_row(self, begin_ns);
    self->row.age_s =
        fresh ? 1e-9 * (double)(int64_t)(begin_ns - self->motion.arrived_ns) : (double)NAN;
    if (!at_work(self)) {
        self->row.call = SP_CALL_NONE;
        self->row.returned_n = 0.0;
        self->row.position_m = fresh ? self->motion.position_m : self->row.position_m;
        self->row.velocity_mps = fresh ? self->motion.velocity_mps : self->row.velocity_mps;
    } else {
        call_scene(self, fresh);
    }
    check_limits(self);
    send_force(self, behind);
    self->stale += !fresh;
    self->late += begin_ns - self->deadline_ns > self->period_ns && begin_ns > self->deadline_ns;
    self->ticks++;
    sp_ring_put(&self->ring, &self->row);
}

/* The next deadline; it follows the device's clock, a twentieth of a percent at most, so that a
 * sample has come a quarter of a period before it is used. */
static void advance(sp_loop *self, int fresh)
{
    int64_t step_ns = (int64_t)self->period_ns;
    if (fresh && self->link != NULL && self->link->fd >= 0) {
        const int64_t most_ns = step_ns / 2000;
        const int64_t early_ns =
            (int64_t)(self->deadline_ns - self->motion.arrived_ns) - step_ns / 4;
        const int64_t slew_ns = early_ns / 64;
        step_ns -= slew_ns > most_ns ? most_ns : slew_ns < -most_ns ? -most_ns : slew_ns;
    }
    self->deadline_ns += (uint64_t)step_ns;
}

static void first_deadline(sp_loop *self)
{
    self->deadline_ns = now();
    if (!self->link->ready) {
        make_ready(self);
    }
    if (self->link->fd >= 0) {
        listen_until(self, self->deadline_ns + first_sample_ns, 1);
        self->deadline_ns = now() + self->period_ns / 4;
    }
    self->start_ns = self->deadline_ns;
    self->end_ns = self->config.seconds > 0
                       ? self->start_ns + (uint64_t)(1e9 * self->config.seconds)
                       : UINT64_MAX;
}

static void stop_device(sp_loop *self)
{
    for (int i = 0; i < 3 && self->link != NULL; i++) {
        if (self->link->write(self->link, now(), 0.0) == SP_LINK_GONE) {
            lose_link(self);
        }
    }
}

static void *run(void *argument)
{
    sp_loop *self = (sp_loop *)argument;
    self->got = sp_realtime_ask(self->config.priority, self->config.cpu);
    first_deadline(self);
    while (!self->reason) {
        listen_until(self, self->deadline_ns, 0);
        accept_wishes(self);
        if (self->want_stop) {
            self->reason = SP_STOP_ASKED;
            break;
        }
        const uint64_t late_ns = now() - self->deadline_ns;
        const int behind = late_ns < UINT64_MAX / 2 && late_ns >= self->period_ns;
        look_for_sample(self, behind);
        if (self->reason) {
            break;
        }
        const int fresh = next_sample(self, behind);
        tick(self, now(), fresh, behind);
        self->elapsed_ns = now() - self->start_ns;
        advance(self, fresh && !behind);
        if (!self->reason && self->deadline_ns >= self->end_ns) {
            self->reason = SP_STOP_TIME;
        }
    }
    stop_device(self);
    self->over = 1;
    return NULL;
}

uint32_t sp_loop_size(void)
{
    return (uint32_t)sizeof(sp_loop);
}

int sp_loop_start(sp_loop *loop, const sp_loop_config *config, sp_link *link)
{
    memset(loop, 0, sizeof *loop);
    loop->config = *config;
    memcpy(&loop->step, &config->step, sizeof loop->step);
    memcpy(&loop->idle, &config->idle, sizeof loop->idle);
    memcpy(&loop->reset, &config->reset, sizeof loop->reset);
    loop->ring.rows = config->rows;
    loop->ring.mask = config->capacity - 1;
    loop->period_ns = (uint64_t)(1e9 * config->period_s + 0.5);
    loop->motion.measured_n = (double)NAN;
    loop->link = link;
    loop->connected = 1;
    return pthread_create(&loop->thread, NULL, run, loop);
}

void sp_loop_ask_stop(sp_loop *loop)
{
    loop->want_stop = 1;
}

void sp_loop_join(sp_loop *loop)
{
    (void)pthread_join(loop->thread, NULL);
}

void sp_loop_pause(sp_loop *loop, int pause)
{
    loop->want_pause = pause;
}

void sp_loop_reset(sp_loop *loop)
{
    loop->want_reset = 1;
}

void sp_loop_attach(sp_loop *loop, sp_link *link)
{
    loop->next_link = link;
}

void sp_loop_look(sp_loop *loop, sp_loop_state *state)
{
    *state = (sp_loop_state){.ticks = loop->ticks,
                             .late = loop->late,
                             .stale = loop->stale,
                             .ring_dropped = loop->ring.dropped,
                             .watchdog_trips = loop->trips,
                             .disconnects = loop->disconnects,
                             .resets = loop->resets,
                             .newest_row = loop->ring.head,
                             .elapsed_s = 1e-9 * (double)loop->elapsed_ns,
                             .latched = loop->latched,
                             .tripped = loop->tripped,
                             .kept_trip = loop->kept_trip,
                             .connected = loop->connected,
                             .paused = loop->paused,
                             .reason = loop->reason,
                             .over = loop->over,
                             .got = loop->got};
}

uint32_t sp_loop_drain(sp_loop *loop, sp_row *rows, uint32_t n)
{
    return sp_ring_get(&loop->ring, rows, n);
}
