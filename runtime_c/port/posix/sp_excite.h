/* Moving a device that nobody holds, to measure it. To the loop it is a scene.
 *
 * It plays a command, scaled by a gain that is adapted so that the tool swings as far as wanted;
 * once the sign of the force is known, a weak spring and damper keep it near where it began. No
 * force is beyond max_force_n. Beyond max_travel_m to either side, or without samples for the
 * watchdog's time, it is over: no force, latched. */
#ifndef SP_EXCITE_H
#define SP_EXCITE_H

#include <stdint.h>

/* springpot declarations begin */
typedef struct {
    const double *command; /* one value a tick, -1 .. 1 */
    uint32_t n;
    uint32_t at;
    uint32_t quiet_ticks; /* at the beginning: how much the position varies by itself */
    uint32_t pulse_ticks; /* from then on: of a pulse, to and fro; 0: no pulses */
    double seen_m;        /* one more pulse once it moved so far, and thrice as far as by itself */
    double dt_s;
    double max_force_n;
    double max_travel_m;
    double swing_m; /* wanted; 0: the gain stays */
    double gain_n;
    double gain_step_n; /* after half a swing that was too small */
    double sign;        /* 1: a positive force pushes the tool out; -1; 0: not known, no spring */
    double stiffness_npm;
    double damping_nspm;
    double watchdog_s;
    int32_t latched_note;

    double start_m; /* where it began */
    double low_m;
    double high_m;
    double pulse_m; /* where this pulse began */
    double half_m;  /* farthest in this half swing */
    double before_m;
    double velocity_mps; /* filtered */
    double silent_s;
    double beyond_m; /* where it passed the travel limit */
    int32_t begun;
    int32_t seen;
    int32_t beyond;
    int32_t latched;
} sp_excite;

int sp_excite_step(sp_excite *excite, double position_m, double velocity_mps, double *force_n);
int sp_excite_idle(sp_excite *excite, double dt_s, double *force_n);
void sp_excite_reset(sp_excite *excite);
/* springpot declarations end */

#endif
