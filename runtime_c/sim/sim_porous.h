/* A soaked sponge under a skin; its fluid flows out through a porous punch: confined compression
 * of a biphasic layer, with a permeability that falls as it is squeezed.
 *
 * Mow, Kuei, Lai, Armstrong: Biphasic creep and stress relaxation of articular cartilage in
 * compression, J. Biomech. Eng. 102 (1980) 73-84; the permeability exp(-M strain) is Lai's and
 * Mow's (1980). */
#ifndef SIM_POROUS_H
#define SIM_POROUS_H

enum { SIM_POROUS_CELLS = 40 };

typedef struct {
    double stiffer; /* 1, factor on the force */
    double step_s;  /* s, of one sim_porous_step */

    double
        moved_m[SIM_POROUS_CELLS + 1]; /* m, of the solid at the cells' ends; 0: below the skin */
} sim_porous;

/* Undeformed and drained. */
void sim_porous_init(void *material, double stiffer, double step_s);

/* Move the tool to tool_m within step_s; returns the force on it, N. */
double sim_porous_step(void *material, double tool_m);

#endif
