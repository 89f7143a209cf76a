/* A passive model of tables that are given, along a motion. */
#ifndef PASSIVE_RUN_H
#define PASSIVE_RUN_H

#include <stdint.h>

/* springpot declarations begin */
typedef struct {
    double origin_m, u_per_m, bias_n;
    uint32_t n_intervals, n_branches, n_stops, n_constant, n_cubic, n_flow, n_linear, n_damage;
    int recovers, pulls;
    const double *spring, *branches, *loss, *depth_loss, *stops, *radius, *flow_loss, *flow_n;
    const uint8_t *flow_function;
    const double *damage, *healed, *stiffest;
} passive_model;

/* The first n_constant branches have a constant rate. 0, or 1 for a model that is too large. */
int passive_run(const passive_model *model, uint32_t n, const double *depth_m, double *force_n);
/* springpot declarations end */

#endif
