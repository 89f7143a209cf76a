/* A hand that presses a scene at random, for long. */
#ifndef RANDOM_PRESSES_H
#define RANDOM_PRESSES_H

#include "sp_closed_loop.h"

/* springpot declarations begin */
/* What random presses came to. A press lasts from the surface to the surface. */
typedef struct {
    uint64_t presses;
    uint64_t not_finite;   /* forces */
    uint64_t latched;      /* ticks */
    double max_returned_j; /* maximum energy that a press gave back beyond what it took */
    double max_taken_j;
    double deepest_m;
    double first_n; /* mean force in contact in the first and in the last tenth */
    double last_n;
} random_presses;

/* `ticks` of dt_s: the hand intends random smooth strokes between -0.2 and 1 times reach_m.
 * Returns 0, or a negative status of the simulated hand. */
int press_at_random(const sp_closed_loop_scene *scene, sim_tool *hand, uint64_t ticks, double dt_s,
                    double reach_m, uint64_t seed, random_presses *found);
/* springpot declarations end */

#endif
