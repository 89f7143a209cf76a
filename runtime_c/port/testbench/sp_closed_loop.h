/* A scene in closed loop with a simulated hand, on a PC; built once for each number type. */
#ifndef SP_CLOSED_LOOP_H
#define SP_CLOSED_LOOP_H

#include <stdint.h>

#include "sim.h"
#include "sp_real.h"

/* springpot declarations begin */
/* A scene: its sp_step and sp_idle, and a state. */
typedef struct {
    void *step;
    void *idle;
    void *state;
} sp_closed_loop_scene;

enum sp_closed_loop_dropped {
    SP_CLOSED_LOOP_TAKEN = 0,
    SP_CLOSED_LOOP_LOST = 1, /* no sample comes: sp_idle is called */
    SP_CLOSED_LOOP_LATE = 2  /* it comes with the next one, and is stepped before it */
};

/* What happens at each tick; arrays of n. */
typedef struct {
    const double *dt_s;       /* real time that the tick lasts */
    const double *intended_m; /* where the hand intends to be at its end */
    const double *push_n;     /* the hand's force in place of its spring; NaN: the spring */
    const double *error_m;    /* added to the position that the scene sees; may be NaN */
    const uint8_t *dropped;   /* of sp_closed_loop_dropped */
} sp_closed_loop_scenario;

/* What came of it; arrays of n. Position and velocity are true ones at the tick's start; what the
 * sensors saw of them is what the scene was given. */
typedef struct {
    double *position_m;
    double *velocity_mps;
    double *seen_m;
    double *seen_mps;
    double *force_n; /* that the scene returned at the tick's start */
    int32_t *notes;
} sp_closed_loop_trace;

/* Run n ticks of the tool `hand` on the scene. Returns the number of forces that were not finite
 * (they act as 0), or a negative status of the simulated hand. */
int64_t sp_closed_loop_run(const sp_closed_loop_scene *scene, sim_tool *hand, uint32_t n,
                           const sp_closed_loop_scenario *scenario,
                           const sp_closed_loop_trace *trace);
/* springpot declarations end */

#endif
