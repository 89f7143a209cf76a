/* Replay of a recorded session through a scene, tick by tick. */
#define _POSIX_C_SOURCE 200809L
#include "sp_replay.h"

#include "../posix/sp_clock.h"
#include <string.h>

enum { LINE_BYTES = 64 };

/* Push everything else out of the caches, as an idle millisecond of other work would. */
static void read_through(uint8_t *cold, uint64_t bytes)
{
    for (uint64_t i = 0; i < bytes; i += LINE_BYTES) {
        cold[i]++;
    }
}

/* Sleep until the next period; a caller that is late begins a new grid, so that it does not
 * rush to catch up. */
static int sleep_until_next(uint64_t *deadline_ns, double period_s)
{
    const uint64_t now_ns = sp_clock_ns();
    *deadline_ns += (uint64_t)(period_s * 1e9);
    if (now_ns > *deadline_ns) {
        *deadline_ns = now_ns;
        return 0;
    }
    return sp_clock_sleep_until(*deadline_ns);
}

typedef int (*sp_step_function)(void *, sp_real, sp_real, sp_real *);
typedef int (*sp_idle_function)(void *, sp_real, sp_real *);
typedef void (*sp_reset_function)(void *);

/* Run n recorded samples through the scene. */
void sp_replay(void *step, void *state, uint32_t n, const sp_real *position_m,
               const sp_real *velocity_mps, sp_real *force_n, int32_t *notes)
{
    sp_step_function call;
    memcpy(&call, &step, sizeof call);
    for (uint32_t i = 0; i < n; i++) {
        notes[i] = call(state, position_m[i], velocity_mps[i], &force_n[i]);
    }
}

/* Make the calls of a log again: step, idle, reset or none, as `call` says for each tick. */
void sp_replay_calls(void *step, void *idle, void *reset, void *state, uint32_t n,
                     const int32_t *call, const sp_real *position_m, const sp_real *velocity_mps,
                     const sp_real *dt_s, sp_real *force_n, int32_t *notes)
{
    sp_step_function make_step;
    sp_idle_function make_idle;
    sp_reset_function make_reset;
    memcpy(&make_step, &step, sizeof make_step);
    memcpy(&make_idle, &idle, sizeof make_idle);
    memcpy(&make_reset, &reset, sizeof make_reset);
    for (uint32_t i = 0; i < n; i++) {
        if (call[i] & SP_REPLAY_RESET) {
            make_reset(state);
        }
        if (call[i] & SP_REPLAY_NONE) {
            continue;
        }
        notes[i] = call[i] & SP_REPLAY_IDLE
                       ? make_idle(state, dt_s[i], &force_n[i])
                       : make_step(state, position_m[i], velocity_mps[i], &force_n[i]);
    }
}

/* Time each tick, ns, one a period as a device would call it. cold: memory that is read through
 * before each, so that the scene's tables are not in the cache. */
int sp_replay_time_ticks(void *step, void *state, uint32_t n, const sp_real *position_m,
                         const sp_real *velocity_mps, double period_s, uint8_t *cold,
                         uint64_t cold_bytes, double *tick_ns)
{
    sp_step_function call;
    memcpy(&call, &step, sizeof call);
    uint64_t deadline_ns = sp_clock_ns();
    for (uint32_t i = 0; i < n; i++) {
        sp_real force_n;
        read_through(cold, cold_bytes);
        const int error = sleep_until_next(&deadline_ns, period_s);
        if (error != 0) {
            return error;
        }
        const uint64_t begin_ns = sp_clock_ns();
        (void)call(state, position_m[i], velocity_mps[i], &force_n);
        tick_ns[i] = (double)(sp_clock_ns() - begin_ns);
    }
    return 0;
}
