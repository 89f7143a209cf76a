/* springpot: the force of a recorded soft object, tick by tick.
 *
 * The loop of a haptic device, at the rate that sp_scene.h and sp_manifest() state:
 *
 *     static sp_state state;                  (from sp_scene.h; on a PC, sp_state_size() bytes)
 *     sp_init(&state);
 *     every period:  sp_step(&state, position_m, velocity_mps, &force_n);
 *     no sample came: sp_idle(&state, period_s, &force_n);
 *
 * Signs: position is the penetration from the undeformed surface, positive into the object; at or
 * below 0 there is no contact. Force is positive where it pushes the tool out of the object.
 * Units: m, m/s, N, s.
 *
 * No function allocates, blocks, reads a clock, or keeps anything outside the state, and states are
 * independent. Use one state in one thread. Send the force in the tick that computed it: one tick
 * of delay costs most of the stiffness that a loop can render stably.
 *
 * Time goes on without samples. After missed or rejected samples (sp_idle, a note HELD) the next
 * good one advances the object's memory, the coupling's proxy and every filter through the missed
 * ticks, as if the tool had moved evenly; the force is then the model's again at once. Such a call
 * takes as long as the missed ticks together. Without a good sample the force never rises. If that
 * lasts longer than the watchdog timeout, or happens again and again, the force falls to zero and
 * stays there until sp_reset.
 *
 * Return values: 0, no notes; positive, notes (bits in sp_notes.h), the force is safe; negative,
 * misuse: nothing has changed, and *force_n was not written.
 */
#ifndef SP_H
#define SP_H

#include <stdint.h>

#include "sp_notes.h"
#include "sp_real.h"

#ifdef __cplusplus
extern "C" {
#endif

/* springpot declarations begin */
typedef struct sp_state sp_state;

/* Version of this interface; a host refuses a library of another version. */
uint32_t sp_abi_version(void);

/* Bytes of one sp_state; align it like a double. */
uint32_t sp_state_size(void);

/* JSON: version, hash, units, sample time, number type, trained range. */
const char *sp_manifest(void);

/* sp_init: first call on a state. sp_reset: the same for a state in use; unlatches the watchdog. */
void sp_init(sp_state *state);
void sp_reset(sp_state *state);

/* One tick: takes the newest position (m), writes the force (N). velocity_mps is not used: a
 * coupling estimates the velocity from positions, which a second signal could contradict. */
int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n);

/* n ticks in order. velocity_mps is not used and may be null. Returns the notes of all ticks. */
int sp_run(sp_state *state, uint32_t n, const sp_real *position_m, const sp_real *velocity_mps,
           sp_real *force_n);

/* dt_s (s) have passed without a sample: the force holds until the watchdog latches, then falls to
 * zero. */
int sp_idle(sp_state *state, sp_real dt_s, sp_real *force_n);

/* springpot pictures begin */
/* For a game's picture, without a hand in the loop: run the ticks of `seconds` with the tool on a
 * straight line from where it was to position_m, no faster than a hand and no deeper than trained,
 * and keep the rest of a tick for the next call. Of more than 1 s the last second counts. NaN
 * leaves the tool where it was (note HELD); no position latches. Writes the force of the last tick.
 * Returns the notes of all ticks, or an error. */
int sp_advance(sp_state *state, sp_real seconds, sp_real position_m, sp_real *force_n);

/* springpot pictures end */
/* springpot places begin */
/* Set the site, m, that is pressed from the next contact on; before the first call it is the
 * stiffest one. sp_reset keeps the site. Beyond the recorded sites the nearest one is rendered. */
void sp_place(sp_state *state, sp_real x_m, sp_real y_m);

/* springpot places end */
/* Replay the golden ticks and compare bits. Returns 0 if all agree, else 1 + the first tick that
 * differs (n_ticks + 1: a NaN comparison or the latch test failed). Catches a compiler whose
 * defaults change floating-point results. Needs sp_state_size() bytes more stack than a tick. */
int sp_selftest(void);
/* springpot declarations end */

#ifdef __cplusplus
}
#endif

#endif
