/* Soft tissue over a stiff bed: it stiffens a hundredfold over a tenth of its depth, and relaxes
 * as Fung's quasi-linear theory says, at all times from 6 ms to 8 s alike. */
#ifndef SIM_TISSUE_H
#define SIM_TISSUE_H

enum { SIM_TISSUE_BRANCHES = 24 };

typedef struct {
    double stiffer;                   /* 1, factor on the force */
    double gain[SIM_TISSUE_BRANCHES]; /* 1, share of the way a branch relaxes in one step */

    double surface_m;                   /* m, depth of the surface; not above the tool */
    double elastic_n;                   /* N, elastic response at surface_m */
    double memory[SIM_TISSUE_BRANCHES]; /* N, elastic response that each branch has relaxed to */
} sim_tissue;

/* Undeformed and relaxed. */
void sim_tissue_init(void *material, double stiffer, double step_s);

/* Move the tool to tool_m within the step; returns the force on it, N. */
double sim_tissue_step(void *material, double tool_m);

#endif
