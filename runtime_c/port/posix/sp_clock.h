/* The clock that never goes back, ns, and a sleep until it shows a time: 0, or an error. */
#ifndef SP_CLOCK_H
#define SP_CLOCK_H

#include <stdint.h>

#if defined(_WIN32)
#include <windows.h>

static inline uint64_t sp_clock_ns(void)
{
    LARGE_INTEGER now, rate;
    (void)QueryPerformanceCounter(&now);
    (void)QueryPerformanceFrequency(&rate);
    const uint64_t count = (uint64_t)now.QuadPart, hz = (uint64_t)rate.QuadPart;
    return count / hz * 1000000000u + count % hz * 1000000000u / hz;
}

/* Sleep until the monotonic clock says until_ns. Returns 0 or an error number. */
static inline int sp_clock_sleep_until(uint64_t until_ns)
{
    static const uint64_t spun_ns = 600000; /* a timer of high resolution is that late at most */
    static _Thread_local HANDLE timer;
    uint64_t now_ns;
    if (timer == NULL) { /* 2: CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, Windows 10 1803 */
        timer = CreateWaitableTimerExW(NULL, NULL, 2, TIMER_ALL_ACCESS);
    }
    while ((now_ns = sp_clock_ns()) < until_ns) {
        if (timer != NULL && until_ns - now_ns > spun_ns) {
            const LARGE_INTEGER due = {.QuadPart =
                                           -(LONGLONG)((until_ns - now_ns - spun_ns) / 100)};
            (void)SetWaitableTimer(timer, &due, 0, NULL, NULL, FALSE);
            (void)WaitForSingleObject(timer, 100);
        } else {
            YieldProcessor();
        }
    }
    return 0;
}
#else
#include <time.h>

static inline uint64_t sp_clock_ns(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

#if defined(__APPLE__) /* which has no clock_nanosleep */
/* Sleep until the monotonic clock says until_ns. Returns 0 or an error number. */
static inline int sp_clock_sleep_until(uint64_t until_ns)
{
    uint64_t now_ns;
    while ((now_ns = sp_clock_ns()) < until_ns) {
        const struct timespec left = {.tv_sec = (time_t)((until_ns - now_ns) / 1000000000u),
                                      .tv_nsec = (long)((until_ns - now_ns) % 1000000000u)};
        (void)nanosleep(&left, NULL);
    }
    return 0;
}
#else
/* Sleep until the monotonic clock says until_ns. Returns 0 or an error number. */
static inline int sp_clock_sleep_until(uint64_t until_ns)
{
    const struct timespec until = {.tv_sec = (time_t)(until_ns / 1000000000u),
                                   .tv_nsec = (long)(until_ns % 1000000000u)};
    return clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
}
#endif
#endif

#endif
