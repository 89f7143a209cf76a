/* An object of the list, with the tool on it moved in samples of several steps. */
#ifndef SIM_OBJECT_H
#define SIM_OBJECT_H

#include "sim.h"
#include "sim_material.h"

enum { SIM_MAX_SUBSTEPS = 4096 };

struct sim_object {
    sim_material material;
    double dt_s;       /* s, between samples */
    uint32_t substeps; /* of one dt_s */
    double tool_m;     /* m, last sample */
};

/* 1 where no value is infinite or NaN, else 0. */
int sim_all_finite(uint32_t n, const double *values);

#endif
