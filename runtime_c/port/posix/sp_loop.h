/* The real-time loop of a PC: a thread on absolute deadlines that reads samples, calls the scene,
 * and sends the force in the same period. Another thread starts it, watches counters, drains a ring
 * of rows, and stops it; nothing that other thread does or fails to do delays a tick.
 *
 * Every period gives one row, in order, whatever happened in it: with a sample the scene's sp_step
 * was called, without one sp_idle; the row holds the inputs bit for bit and what was returned.
 *
 * A sample that comes late is that of its period all the same. A period without one gets the last
 * force again and stays open, for 2 ms and one period at least; samples that come meanwhile are
 * given to the open periods, oldest first, before that of the period under way. Where fewer come
 * than periods are open, the oldest of these were without, and are settled with sp_idle. So silence
 * reaches the scene's watchdog, and latches it, as much later. A thread that was kept away makes up
 * for its missed periods at once, with the samples that came meanwhile: time is complete.
 *
 * Samples that no period has room for are thrown away, the oldest first (`unused`): those of a
 * device that sends more than one a period, and those of periods that were settled without. What
 * is left waiting is for periods that have begun: the newest sample is never older than that.
 *
 * Built once for each number type.
 */
#ifndef SP_LOOP_H
#define SP_LOOP_H

#include <stdint.h>

#include "sp_link.h"
#include "sp_real.h"

/* springpot declarations begin */
enum { /* why a loop ended */
       SP_STOP_NONE = 0,
       SP_STOP_ASKED = 1,
       SP_STOP_TIME = 2,
       SP_STOP_FORCE = 3,  /* beyond max_force_n */
       SP_STOP_DEPTH = 4,  /* beyond max_depth_m */
       SP_STOP_ENDED = 5,  /* the replay has no more samples */
       SP_STOP_MISUSE = 6, /* the scene refused its arguments */
       SP_STOP_RATE = 7,   /* for a fifth of the last 100 periods no sample came */
       SP_STOP_BUTTON = 8  /* the device's own button */
};

enum {                     /* bits of sp_row.call */
       SP_CALL_IDLE = 1,   /* sp_idle(dt_s), otherwise sp_step(position_m, velocity_mps) */
       SP_CALL_RESET = 2,  /* sp_reset before it */
       SP_CALL_NONE = 4,   /* no call: paused, or the device had switched its motor off */
       SP_CALL_SILENT = 8, /* zero was sent instead of the returned force */
       SP_CALL_UNSENT = 16 /* what was returned was not sent: no device, no room, or the next
                              period had begun */
};

enum { SP_GRANTED_FIFO = 1, SP_GRANTED_LOCKED = 2, SP_GRANTED_SLACK = 4, SP_GRANTED_CPU = 8 };

typedef struct {         /* one period; doubles throughout, so that a table of rows is a matrix */
    double time_s;       /* when the tick began, since the first deadline */
    double position_m;   /* given to sp_step as sp_real; in an idle period that of the last sp_step;
                            in one without a call where the tool is */
    double velocity_mps; /* likewise */
    double dt_s;         /* given to sp_idle; in other periods the scene's */
    double returned_n;
    double sent_n;     /* what the device had last been sent when the tick ended */
    double measured_n; /* NaN where there is no load cell, or no device */
    double notes;
    double call;
    double age_s;      /* of the sample when the scene was given it; NaN without a new one */
    double lateness_s; /* of the tick behind its deadline */
    double tick_s;     /* time that the scene's call took */
} sp_row;

typedef struct {
    void *step;  /* int (void *state, sp_real position, sp_real velocity, sp_real *force) */
    void *idle;  /* int (void *state, sp_real dt_s, sp_real *force) */
    void *reset; /* void (void *state) */
    void *state;
    double *measured_n; /* where a state wants the measured force before each step, or null */
    double period_s;
    double seconds; /* 0: until it is stopped */
    double max_force_n;
    double max_depth_m;
    int32_t latched_note;
    int32_t reversed; /* the device pulls for a positive force: it is sent with the other sign */
    int32_t sensed; /* what is measured comes by sp_loop_set_measured_force, not with the samples */
    int32_t priority; /* of SCHED_FIFO; 0: do not ask for it */
    int32_t cpu;      /* to run on, or negative */
    sp_row *rows;     /* the ring, `capacity` of them, a power of two */
    uint32_t capacity;
} sp_loop_config;

typedef struct {
    uint64_t ticks;
    uint64_t late;   /* more than one period behind */
    uint64_t stale;  /* without a sample of its own */
    uint64_t unused; /* samples that no period had room for */
    uint64_t ring_dropped;
    uint64_t watchdog_trips;
    uint64_t disconnects;
    uint64_t resets;
    uint64_t start_ns;   /* of CLOCK_MONOTONIC, where rows count from */
    uint64_t newest_row; /* rows put into the ring since the start */
    double elapsed_s;
    int32_t latched;
    int32_t tripped;                   /* the device itself */
    int32_t tripped_before_disconnect; /* had tripped before a disconnect: the device's return does
                                          not reset it */
    int32_t connected;
    int32_t paused;
    int32_t reason;
    int32_t over; /* the thread has ended, zero force sent */
    int32_t got;  /* SP_GOT_ bits */
} sp_loop_state;

typedef struct sp_loop sp_loop;
uint32_t sp_loop_size(void);

/* Start the thread on a link: 0, or an error of pthread_create. All memory stays the caller's and
 * must live until sp_loop_join. */
int sp_loop_start(sp_loop *loop, const sp_loop_config *config, sp_link *link);
void sp_loop_request_stop(sp_loop *loop);
/* Wait for its end: 1, or 0 where that was done before. */
int sp_loop_join(sp_loop *loop);
/* Zero force and no calls until resumed; the scene is reset then. */
void sp_loop_pause(sp_loop *loop, int pause);
void sp_loop_reset(sp_loop *loop);
/* After a disconnect: go on with this link, the scene reset once, unless it had tripped before. */
void sp_loop_attach(sp_loop *loop, sp_link *link);
/* A force sensor beside the device measured this, just now; from any thread. Where nothing came for
 * 100 ms, or never, rows have NaN. */
void sp_loop_set_measured_force(sp_loop *loop, double measured_n);
void sp_loop_get_status(sp_loop *loop, sp_loop_state *state);
/* Copy up to n rows that were not drained yet; how many. One thread only. */
uint32_t sp_loop_drain(sp_loop *loop, sp_row *rows, uint32_t n);
/* springpot declarations end */

#endif
