/* Replay and timing of a scene on a PC, through its sp_step; built once for each number type. */
#ifndef SP_REPLAY_H
#define SP_REPLAY_H

#include <stdint.h>

#include "sp_real.h"

/* springpot declarations begin */
/* Run n ticks through `step` (a scene's sp_step), keeping every tick's notes. */
void sp_replay(void *step, void *state, uint32_t n, const sp_real *position_m,
               const sp_real *velocity_mps, sp_real *force_n, int32_t *notes);

/* Time each of n ticks, ns, one every period_s (s), with `cold_bytes` of other memory walked in
 * between. Returns 0, or the error of the clock. */
int sp_pace(void *step, void *state, uint32_t n, const sp_real *position_m,
            const sp_real *velocity_mps, double period_s, uint8_t *cold, uint64_t cold_bytes,
            double *tick_ns);
/* springpot declarations end */

#endif
