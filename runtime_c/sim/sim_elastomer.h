/* A filled elastomer of Bergström and Boyce under a flat punch: two networks of chains side by
 * side, of which one creeps, the faster the higher its stress, the slower the further it has crept.
 *
 * Bergström, Boyce: Constitutive modeling of the large strain time-dependent behavior of
 * elastomers, J. Mech. Phys. Solids 46 (1998) 931-954. */
#ifndef SIM_ELASTOMER_H
#define SIM_ELASTOMER_H

typedef struct {
    double stiffer; /* 1, factor on the force */
    double step_s;  /* s, of one sim_elastomer_step */

    double surface_m;  /* m, depth of the surface; not above the tool */
    double creep;      /* 1, logarithm of the stretch that the second network has crept to */
    double rate_psmpa; /* 1/s at 1 MPa, of the creep during this step */
} sim_elastomer;

/* Undeformed and relaxed. */
void sim_elastomer_init(void *material, double stiffer, double step_s);

/* Move the tool to tool_m within step_s; returns the force on it, N. */
double sim_elastomer_step(void *material, double tool_m);

#endif
