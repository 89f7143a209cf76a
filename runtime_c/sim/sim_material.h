/* One silicone under a flat tip: two elastic branches, each with eleven Maxwell modes, and a
 * little friction that does not depend on rate. */
#ifndef SIM_MATERIAL_H
#define SIM_MATERIAL_H

enum { SIM_BRANCHES = 2, SIM_MODES = 11 };

typedef struct {
    double branch_n;   /* N, slow force of each branch at 10 mm, before stiffening */
    double relaxation; /* 1, force that relaxes, relative to the slow force */
    double friction_n; /* N, maximum friction */
    double eyring_n;   /* N, force that speeds relaxation up by 1.18; 0: none does */
    double step_s;     /* s, of one sim_material_step */
} sim_material_config;

typedef struct {
    sim_material_config config;
    double strength_n[SIM_BRANCHES][SIM_MODES]; /* N, of each mode at 10 mm */
    double gain[SIM_MODES];                     /* 1, share of the way a mode goes in one step */

    double surface_m;                       /* m, depth of the surface; not above the tool */
    double shape[SIM_BRANCHES];             /* 1, branches at surface_m, 1 at 10 mm */
    double memory[SIM_BRANCHES][SIM_MODES]; /* 1, shape that each mode has relaxed to */
    double stretch_m;                       /* m, of the friction's spring */
    double force_n;                         /* N, on the tool; never negative */
} sim_material;

/* Undeformed and relaxed. */
void sim_material_init(sim_material *material, const sim_material_config *config);

/* Move the tool to tool_m within config.step_s; returns the force on it, N. */
double sim_material_step(sim_material *material, double tool_m);

#endif
