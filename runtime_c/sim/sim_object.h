/* An object of the list, with the tool on it moved in samples of several steps. */
#ifndef SIM_OBJECT_H
#define SIM_OBJECT_H

#include "sim.h"
#include "sim_damaged.h"
#include "sim_elastomer.h"
#include "sim_lump.h"
#include "sim_material.h"
#include "sim_porous.h"
#include "sim_tissue.h"

enum { SIM_MAX_SUBSTEPS = 4096 };

struct sim_object {
    union {
        sim_material silicone;
        sim_elastomer elastomer;
        sim_tissue tissue;
        sim_damaged damaged;
        sim_porous porous;
        sim_lump lump;
    } material;
    double (*step)(void *material, double tool_m); /* of that material; returns the force, N */

    double dt_s;       /* s, between samples */
    uint32_t substeps; /* of one dt_s */
    double step_s;     /* s, of one substep */
    double tool_m;     /* m, last sample */
    double force_n;    /* N, on the tool after the last substep */
};

/* Move the tool to tool_m within one substep; the force on it is force_n. */
void sim_object_substep(sim_object *object_state, double tool_m);

/* 1 where no value is infinite or NaN, else 0. */
int sim_all_finite(uint32_t n, const double *values);

#endif
