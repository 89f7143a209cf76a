/* A filled rubber that softens when it is pressed deeper than before (Mullins), heals in a minute,
 * adapts within a press and drifts over minutes.
 *
 * Ogden, Roxburgh: A pseudo-elastic model for the Mullins effect in filled rubber,
 * Proc. R. Soc. A 455 (1999) 2861-2877. The healing is ours. */
#ifndef SIM_DAMAGED_H
#define SIM_DAMAGED_H

enum { SIM_DAMAGED_BRANCHES = 2 };

typedef struct {
    double stiffer;                    /* 1, factor on the force */
    double healing;                    /* 1, share of the damage that heals in one step */
    double gain[SIM_DAMAGED_BRANCHES]; /* 1, share of the way a branch relaxes in one step */

    double surface_m;                    /* m, depth of the surface; not above the tool */
    double damage_j;                     /* J, energy up to which it has been damaged */
    double memory[SIM_DAMAGED_BRANCHES]; /* N, undamaged force that each branch has relaxed to */
} sim_damaged;

/* Undeformed, relaxed and undamaged. */
void sim_damaged_init(void *material, double stiffer, double step_s);

/* Move the tool to tool_m within the step; returns the force on it, N. */
double sim_damaged_step(void *material, double tool_m);

#endif
