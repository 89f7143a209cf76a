/* springpot: the feel of a recorded soft object, one force a tick.
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
 * Nothing here allocates, blocks, reads a clock, or keeps anything outside the state; two states
 * never meet. One state belongs to one thread. Send the force in the tick that computed it: one
 * tick of delay costs most of the stiffness that a loop can render stably.
 *
 * Time goes on without samples. Whatever was missed (sp_idle, a sample that is not believed), the
 * next good sample makes up for: the object's memory, the coupling's proxy and every
 * filter go through those ticks as if the tool had moved evenly since the last good sample, and the
 * force is the model's again at once where that is lower, within 10 ms where it is higher. Such a
 * call takes as many ticks' time as went by. Without a good sample the force never rises; if that
 * lasts for longer than the watchdog's time, or comes again and again, it goes to zero and stays
 * there until sp_reset.
 *
 * What a call returns: 0, fine; positive, notes (bits, in sp_notes.h): the force is safe; negative,
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

/* Version of this interface; a host refuses a library of another. */
uint32_t sp_abi_version(void);

/* Bytes of one sp_state; align it as for double. */
uint32_t sp_state_size(void);

/* JSON: version, hash, units, sample time, number type, trained range. */
const char *sp_manifest(void);

/* First call on a state; sp_reset is the same for a state in use, and unlatches the watchdog. */
void sp_init(sp_state *state);
void sp_reset(sp_state *state);

/* One tick: the newest position (m) in, the force (N) out. velocity_mps is not used: a coupling
 * estimates the tool's own, since a second signal of the same motion could contradict the first. */
int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n);

/* n ticks in order; velocity_mps, not used, may be null. Returns all notes. */
int sp_run(sp_state *state, uint32_t n, const sp_real *position_m, const sp_real *velocity_mps,
           sp_real *force_n);

/* dt_s (s) have passed without a sample: the force stays, or falls if the tool was on its way out,
 * until the watchdog takes it to zero. */
int sp_idle(sp_state *state, sp_real dt_s, sp_real *force_n);

/* springpot places begin */
/* Where the object is pressed from the next contact on, m; until it is called, the stiffest place.
 * sp_reset keeps it. Beyond the recorded places the nearest of them is felt. */
void sp_place(sp_state *state, sp_real x_m, sp_real y_m);

/* springpot places end */
/* Replay the golden vectors that were emitted and compare bits: 0, or 1 + the first tick that
 * differs, or one more than there are ticks where NaN is assumed away or a long silence does not
 * latch. Catches a compiler with defaults that change floating-point results. Needs sp_state_size()
 * bytes of stack more than a tick. */
int sp_selftest(void);
/* springpot declarations end */

#ifdef __cplusplus
}
#endif

#endif
