/* Thread of the real-time loop: start, deadlines, requests of the other thread, end. */
#include "sp_loop.h"

#include <math.h>
#include <string.h>

#include "sp_loop_self.h"
#include "sp_realtime.h"

static const uint64_t first_sample_ns = 200000000; /* longest wait for it before the first tick */
/* How long a period stays open for its sample, if that is more than one period. What holds samples
 * back is mostly a USB host, which hands them over once a ms; the scene's watchdog must not hear of
 * silence much later. */
static const uint64_t max_open_ns = 2000000;

/* Take over what the host's thread has asked for since the last tick: another link, a reset, a
 * pause. */
static void accept_requests(sp_loop *self)
{
    sp_link *next = atomic_exchange(&self->next_link, NULL);
    if (next != NULL) {
        self->link = next;
        self->tripped = self->tripped && self->tripped_before_disconnect;
        self->reset_next = self->reset_next || !self->tripped_before_disconnect;
        self->connected = 1;
        self->waiting_count = 0;
        self->motion.measured_n = (double)NAN;
        sp_loop_reset_rate_window(self);
        self->arming_ns = 0;
        if (!next->ready) {
            sp_loop_arm_device(self);
        }
    }
    if (atomic_exchange(&self->want_reset, 0)) {
        self->reset_next = 1;
        self->tripped = 0;
        if (self->link != NULL) {
            sp_loop_arm_device(self);
        }
    }
    const int pause = self->want_pause;
    if (self->paused && !pause) {
        self->reset_next = 1;
    }
    self->paused = pause;
}

/* The next deadline; it follows the device's clock, a twentieth of a percent at most, so that a
 * sample has come a quarter of a period before it is used. */
static void advance(sp_loop *self, int fresh)
{
    int64_t step_ns = (int64_t)self->period_ns;
    if (fresh && self->link != NULL && self->link->fd >= 0) {
        const int64_t max_ns = step_ns / 2000;
        const int64_t early_ns =
            (int64_t)(self->deadline_ns - self->motion.arrived_ns) - step_ns / 4;
        const int64_t slew_ns = early_ns / 64;
        step_ns -= slew_ns > max_ns ? max_ns : slew_ns < -max_ns ? -max_ns : slew_ns;
    }
    self->deadline_ns += (uint64_t)step_ns;
}

/* Set the first deadline just behind a sample's arrival, so that samples are fresh when they
 * are used. */
static void first_deadline(sp_loop *self)
{
    self->deadline_ns = sp_loop_now();
    if (!self->link->ready) {
        sp_loop_arm_device(self);
    }
    if (self->link->fd >= 0) {
        /* What came first may have waited for long; what comes after it has just come. */
        sp_loop_wait_for_samples(self, self->deadline_ns + first_sample_ns, 1);
        sp_loop_wait_for_samples(self, sp_loop_now() + 2 * self->period_ns,
                                 self->waiting_count + 1);
        sp_loop_consume_samples(self, self->waiting_count - (self->waiting_count > 0));
        self->deadline_ns = sp_loop_now() + self->period_ns / 4;
    }
    self->start_ns = self->deadline_ns;
    self->begun_ns = self->start_ns;
    self->end_ns = self->config.seconds > 0
                       ? self->start_ns + (uint64_t)(1e9 * self->config.seconds)
                       : UINT64_MAX;
}

/* Thread of the loop: wait for the deadline, take the sample, compute and send the force, until
 * something ends it; then send zero. */
static void *run(void *argument)
{
    sp_loop *self = (sp_loop *)argument;
    self->got = sp_realtime_request(self->config.priority, self->config.cpu);
    first_deadline(self);
    while (!self->reason) {
        sp_loop_wait_for_samples(self, self->deadline_ns, 0);
        accept_requests(self);
        if (self->want_stop) {
            self->reason = SP_STOP_ASKED;
            break;
        }
        const uint64_t now_ns = sp_loop_now();
        const uint64_t late_ns = now_ns > self->deadline_ns ? now_ns - self->deadline_ns : 0;
        const int behind = late_ns >= self->period_ns;
        sp_loop_collect_samples(self, late_ns);
        if (self->reason) {
            break;
        }
        const int fresh = sp_loop_tick(self, behind);
        self->elapsed_ns = sp_loop_now() - self->start_ns;
        advance(self, fresh && !behind);
        if (!self->reason && self->deadline_ns >= self->end_ns) {
            self->reason = SP_STOP_TIME;
        }
    }
    sp_loop_stop_device(self);
    if (self->reason == SP_STOP_ASKED || self->reason == SP_STOP_TIME) {
        sp_loop_close_open_periods(self);
    }
    self->over = 1;
    return NULL;
}

uint32_t sp_loop_size(void)
{
    return (uint32_t)sizeof(sp_loop);
}

/* Start the loop's thread. Returns 0 or pthread's error. */
int sp_loop_start(sp_loop *loop, const sp_loop_config *config, sp_link *link)
{
    memset(loop, 0, sizeof *loop);
    loop->config = *config;
    /* ISO C converts no void * to a function pointer: its bytes are copied. */
    memcpy(&loop->step, &config->step, sizeof loop->step);
    memcpy(&loop->idle, &config->idle, sizeof loop->idle);
    memcpy(&loop->reset, &config->reset, sizeof loop->reset);
    loop->ring.rows = config->rows;
    loop->ring.mask = config->capacity - 1;
    loop->period_ns = (uint64_t)(1e9 * config->period_s + 0.5);
    /* Periods that may wait for a late sample: those of max_open_ns, at least one. */
    const uint64_t open_periods = max_open_ns / loop->period_ns;
    loop->max_open = open_periods < 1                  ? 1
                     : open_periods > MAX_OPEN_PERIODS ? MAX_OPEN_PERIODS
                                                       : (int)open_periods;
    loop->motion.measured_n = (double)NAN;
    loop->link = link;
    loop->connected = 1;
    return pthread_create(&loop->thread, NULL, run, loop);
}

void sp_loop_request_stop(sp_loop *loop)
{
    loop->want_stop = 1;
}

/* Wait for the end of the thread. Returns 0 where that was done before. */
int sp_loop_join(sp_loop *loop)
{
    if (loop->joined) {
        return 0;
    }
    loop->joined = 1;
    (void)pthread_join(loop->thread, NULL);
    return 1;
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

void sp_loop_set_measured_force(sp_loop *loop, double measured_n)
{
    loop->sensed_n = measured_n;
    loop->sensed_ns = sp_loop_now();
}

/* Copy counters and flags for the host's thread. */
void sp_loop_get_status(sp_loop *loop, sp_loop_state *state)
{
    *state = (sp_loop_state){.ticks = loop->ticks,
                             .late = loop->late,
                             .stale = loop->stale,
                             .unused = loop->unused,
                             .ring_dropped = loop->ring.dropped,
                             .watchdog_trips = loop->trips,
                             .disconnects = loop->disconnects,
                             .resets = loop->resets,
                             .start_ns = loop->begun_ns,
                             .newest_row = loop->ring.head,
                             .elapsed_s = 1e-9 * (double)loop->elapsed_ns,
                             .latched = loop->latched,
                             .tripped = loop->tripped,
                             .tripped_before_disconnect = loop->tripped_before_disconnect,
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
