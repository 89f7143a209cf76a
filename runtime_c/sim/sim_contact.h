/* A tool on a surface that pushes and never pulls: what every material's step has in common. */
#ifndef SIM_CONTACT_H
#define SIM_CONTACT_H

#include "sim_root.h"

typedef struct {
    double depth_m; /* m, of the surface at the end of the step; not above the tool's */
    double force_n; /* N, on the tool; never negative */
} sim_contact;

/* force_at: N, of a material with its surface at a depth, m, at the end of the step; it rises with
 * depth and may be negative. surface_m: before the step. deepest_m: where the force is positive,
 * whatever came before. */
sim_contact sim_contact_solve(sim_rising force_at, const void *material, double tool_m,
                              double surface_m, double deepest_m);

#endif
