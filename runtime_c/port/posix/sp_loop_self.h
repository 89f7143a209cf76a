/* What the files of the loop share: its state, and what becomes of its device. */
#ifndef SP_LOOP_SELF_H
#define SP_LOOP_SELF_H

#include <pthread.h>
#include <stdint.h>

#include "sp_loop.h"
#include "sp_ring.h"

typedef int (*step_function)(void *, sp_real, sp_real, sp_real *);
typedef int (*idle_function)(void *, sp_real, sp_real *);
typedef void (*reset_function)(void *);

/* Samples of a second at 1 kHz: what waits in a descriptor is no silence of the device. */
enum { MAX_WAITING = 1024 };

/* Periods of 2 ms at 8 kHz: as many stay open for their samples. */
enum { MAX_OPEN_PERIODS = 16 };

/* Too few samples: 20 of the last 100 calls were without. Of a silence the first 6 count only: its
 * length is the matter of the scene's watchdog. Nor does a call with a sample too late for it.
 */
enum { RATE_WINDOW = 100, MAX_IDLE_IN_WINDOW = 20, MAX_COUNTED_RUN = 6 };

typedef struct { /* a period that has no row yet */
    uint64_t begin_ns;
    uint64_t deadline_ns;
    double sent_n; /* what the device had last been sent when it ended */
} sp_period;

struct sp_loop {
    sp_loop_config config;
    step_function step;
    idle_function idle;
    reset_function reset;
    pthread_t thread;
    int joined;
    sp_ring ring;

    /* Asked by the other thread. */
    _Atomic int want_stop;
    _Atomic int want_pause;
    _Atomic int want_reset;
    _Atomic(sp_link *) next_link;
    _Atomic double sensed_n;
    _Atomic uint64_t sensed_ns; /* 0: never */

    /* Read by the other thread, under no lock: each by itself. */
    _Atomic uint64_t ticks, late, stale, unused, trips, disconnects, resets, elapsed_ns, begun_ns;
    _Atomic int connected, latched, tripped, tripped_before_disconnect, paused, reason, over, got;

    /* The thread's own. */
    sp_link *link;
    sp_motion motion;               /* that the scene was given last */
    sp_motion waiting[MAX_WAITING]; /* samples that no tick has used, oldest first */
    int waiting_count;
    uint64_t period_ns, start_ns, deadline_ns, end_ns;
    int reset_next;     /* the scene, before its next call */
    uint64_t arming_ns; /* since when the device was asked to be ready; 0: it is */
    sp_row row;
    sp_period open_periods[MAX_OPEN_PERIODS]; /* open ones before the one under way, oldest first */
    int open_count, max_open;
    double sent_n;
    uint8_t was_idle[RATE_WINDOW]; /* of the last calls, in a ring */
    int idle_count, idle_run, window_index;
};

/* CLOCK_MONOTONIC, ns. */
uint64_t sp_loop_now(void);

/* The device is gone: go on without it. */
void sp_loop_on_disconnect(sp_loop *self);
/* The device switched its motor off by itself. */
void sp_loop_on_device_trip(sp_loop *self);
/* Ask the device to take forces. */
void sp_loop_arm_device(sp_loop *self);
/* At the end: zero force until it was taken three times, or for a fifth of a second. */
void sp_loop_stop_device(sp_loop *self);
/* Whether the scene may be called: no force reaches a device that is not ready. */
int sp_loop_may_call_scene(sp_loop *self);

/* Read what comes until a time, or only until so many samples wait; 0: however many. */
void sp_loop_wait_for_samples(sp_loop *self, uint64_t until_ns, int wanted);
/* So many of the waiting samples, oldest first, wait no longer. */
void sp_loop_consume_samples(sp_loop *self, int count);
/* Have the samples of this period and of those before it that are open; late_ns: how far the thread
 * is behind the period's begin. */
void sp_loop_collect_samples(sp_loop *self, uint64_t late_ns);

/* One period: a row for each of the open ones that has its sample or waits no longer, the force to
 * the device. behind: the next period has begun too. Returns whether there was a sample. */
int sp_loop_tick(sp_loop *self, int behind);
/* At the end: rows for the periods that are still open. */
void sp_loop_close_open_periods(sp_loop *self);
/* Forget how many of the last calls were without a sample. */
void sp_loop_reset_rate_window(sp_loop *self);
/* So many samples came too late for the calls without one. */
void sp_loop_uncount_idle(sp_loop *self, int surplus);

#endif
