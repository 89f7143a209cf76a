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
enum { WAITING = 1024 };

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

    /* Read by the other thread, under no lock: each by itself. */
    _Atomic uint64_t ticks, late, stale, trips, disconnects, resets, elapsed_ns;
    _Atomic int connected, latched, tripped, tripped_before_disconnect, paused, reason, over, got;

    /* The thread's own. */
    sp_link *link;
    sp_motion motion;           /* of this tick */
    sp_motion waiting[WAITING]; /* samples that no tick has used, oldest first */
    int waiting_count;
    uint64_t period_ns, start_ns, deadline_ns, end_ns;
    int reset_next;     /* the scene, before its next call */
    uint64_t arming_ns; /* since when the device was asked to be ready; 0: it is */
    sp_row row;
};

/* CLOCK_MONOTONIC, ns. */
uint64_t sp_loop_now(void);

/* The device is gone: go on without it. */
void sp_loop_lose_link(sp_loop *self);
/* The device switched its motor off by itself. */
void sp_loop_trip(sp_loop *self);
/* Ask the device to take forces. */
void sp_loop_make_ready(sp_loop *self);
/* Whether the scene may be called: no force reaches a device that is not ready. */
int sp_loop_at_work(sp_loop *self);

/* Read what comes until a time, or only until a sample came. */
void sp_loop_listen(sp_loop *self, uint64_t until_ns, int only_first);
/* The sample of this tick at self->motion; whether there is one. behind: the next period has begun
 * too. */
int sp_loop_sample(sp_loop *self, int behind);

/* One period: the scene's call, the limits, the force to the device, the row. */
void sp_loop_tick(sp_loop *self, uint64_t begin_ns, int fresh, int behind);

#endif
