/* The loop of a PC on a clock of the test's own: its thread is a call, and no time passes but what
 * the test lets pass. A program that includes this defines sim_sleep and sim_join. */
#ifndef SIMULATED_CLOCK_H
#define SIMULATED_CLOCK_H

#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include "check.h"

static uint64_t sim_now_ns;

static int sim_clock(clockid_t clock, struct timespec *time);
static int sim_sleep(clockid_t clock, int flags, const struct timespec *until,
                     struct timespec *left);
static int sim_join(void);
#define clock_gettime sim_clock
#define clock_nanosleep sim_sleep
#define pthread_create(thread, attributes, run, argument) ((void)run(argument), 0)
#define pthread_join(thread, result) sim_join()
#include "../../runtime_c/port/posix/sp_loop.c"
#include "../../runtime_c/port/posix/sp_loop_link.c"
#include "../../runtime_c/port/posix/sp_loop_sample.c"
#include "../../runtime_c/port/posix/sp_loop_tick.c"

static int sim_clock(clockid_t clock, struct timespec *time)
{
    CHECK(clock == CLOCK_MONOTONIC);
    time->tv_sec = (time_t)(sim_now_ns / 1000000000u);
    time->tv_nsec = (long)(sim_now_ns % 1000000000u);
    return 0;
}

static uint64_t as_ns(const struct timespec *time)
{
    return (uint64_t)time->tv_sec * 1000000000u + (uint64_t)time->tv_nsec;
}

int32_t sp_realtime_request(int32_t priority, int32_t cpu)
{
    return priority + cpu;
}

#endif
