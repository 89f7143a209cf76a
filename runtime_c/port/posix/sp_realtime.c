/* Real-time scheduling, locked memory, a core of its own: what the system grants. */
#define _GNU_SOURCE
#include "sp_realtime.h"

#if defined(_WIN32)
#include <windows.h>

#include "sp_loop.h"

/* Ask the system for a real-time priority, locked memory and a core of its own for this thread.
 * Returns the SP_GRANTED_ bits of what it gave. */
int32_t sp_realtime_request(int32_t priority, int32_t cpu)
{
    int32_t got = 0;
    if (priority <= 0) {
        return 0;
    }
    got |=
        SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_TIME_CRITICAL) ? SP_GRANTED_FIFO : 0;
    if (cpu >= 0) {
        got |= SetThreadAffinityMask(GetCurrentThread(), (DWORD_PTR)1 << cpu) ? SP_GRANTED_CPU : 0;
    }
    return got;
}
#else
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#if defined(__linux__)
#include <sys/prctl.h>
#endif

#include "sp_loop.h"

/* Ask the system for a real-time priority, locked memory and a core of its own for this thread.
 * Returns the SP_GRANTED_ bits of what it gave. */
int32_t sp_realtime_request(int32_t priority, int32_t cpu)
{
    int32_t got = 0;
    if (priority <= 0) {
        return 0;
    }
    /* Locking takes a tenth of a second, in which nobody else shall wait. */
    got |= mlockall(MCL_CURRENT) == 0 ? SP_GRANTED_LOCKED : 0;
    const struct sched_param param = {.sched_priority = priority};
    got |= pthread_setschedparam(pthread_self(), SCHED_FIFO, &param) == 0 ? SP_GRANTED_FIFO : 0;
#if defined(__linux__)
    got |= prctl(PR_SET_TIMERSLACK, 1UL) == 0 ? SP_GRANTED_SLACK : 0;
    if (cpu >= 0) {
        cpu_set_t set;
        CPU_ZERO(&set);
        CPU_SET((unsigned)cpu, &set);
        got |= pthread_setaffinity_np(pthread_self(), sizeof set, &set) == 0 ? SP_GRANTED_CPU : 0;
    }
#else
    (void)cpu;
#endif
    return got;
}
#endif
