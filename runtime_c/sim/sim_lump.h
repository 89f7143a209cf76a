/* A soft layer with two stiffer, slower lumps in it, under a sphere that is put down at one place
 *: columns side by side that do not pull on each other (Winkler), each of a spring that stiffens as
 * it is squeezed and three Maxwell branches. A column that relaxes more slowly than the sphere
 * leaves it comes back by itself. */
#ifndef SIM_LUMP_H
#define SIM_LUMP_H

enum {
    SIM_LUMP_ACROSS = 33,   /* columns across the sphere, 0.5 mm each */
    SIM_LUMP_COLUMNS = 800, /* 793 are under the sphere, no others reached: eights are fast */
    SIM_LUMP_BRANCHES = 3
};

typedef struct {
    double stiffer; /* 1, factor on the force */
    double step_s;  /* s, of one sim_lump_step */

    double below_m[SIM_LUMP_COLUMNS];       /* m, the sphere's surface above its lowest point */
    double stiffness_npm[SIM_LUMP_COLUMNS]; /* N/m, slow */
    double slope[SIM_LUMP_COLUMNS];         /* 1, at once within a step, over slow */
    double per_slope[SIM_LUMP_COLUMNS];
    double gain[SIM_LUMP_BRANCHES][SIM_LUMP_COLUMNS]; /* 1, share that relaxes in a step */

    double squeezed_m[SIM_LUMP_COLUMNS]; /* m, how much each column is, as its spring feels it */
    double memory_m[SIM_LUMP_BRANCHES][SIM_LUMP_COLUMNS]; /* m, to which each has relaxed */
} sim_lump;

/* Undeformed and relaxed, the sphere above the place 0, 0. */
void sim_lump_init(void *material, double stiffer, double step_s);

/* Undeformed and relaxed, the sphere above another place, m. */
void sim_lump_place(sim_lump *lump, double x_m, double y_m);

/* Move the tool to tool_m within the step; returns the force on it, N. */
double sim_lump_step(void *material, double tool_m);

#endif
