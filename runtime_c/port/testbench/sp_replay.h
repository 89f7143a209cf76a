/* Replay and timing of a scene on a PC, through its sp_step; built once for each number type. */
#ifndef SP_REPLAY_H
#define SP_REPLAY_H

#include <stdint.h>

#include "sp_real.h"

/* springpot declarations begin */
/* Run n ticks through `step` (a scene's sp_step), keeping every tick's notes. */
void sp_replay(void *step, void *state, uint32_t n, const sp_real *position_m,
               const sp_real *velocity_mps, sp_real *force_n, int32_t *notes);

enum { SP_REPLAY_IDLE = 1, SP_REPLAY_RESET = 2, SP_REPLAY_NONE = 4 };

/* Make the calls of a session again: call[i] is bits of the above, sp_step where none of IDLE and
 * NONE is set. Rows without a call keep force and notes as they are. */
void sp_replay_calls(void *step, void *idle, void *reset, void *state, uint32_t n,
                     const int32_t *call, const sp_real *position_m, const sp_real *velocity_mps,
                     const sp_real *dt_s, sp_real *force_n, int32_t *notes);

/* Time each of n ticks, ns, one every period_s (s), with `cold_bytes` of other memory read in
 * between. Returns 0, or the error of the clock. */
int sp_replay_time_ticks(void *step, void *state, uint32_t n, const sp_real *position_m,
                         const sp_real *velocity_mps, double period_s, uint8_t *cold,
                         uint64_t cold_bytes, double *tick_ns);
/* springpot declarations end */

#endif
