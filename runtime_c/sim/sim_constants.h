/* Written by tests/bench/calibrate_sim.py: do not edit. For each object and variant (A, B), what
 * gives Table 1's greatest depth over the training protocol, and a loss per cycle at 1 Hz and 10 N
 * of 0.36, 0.22, 0.15, 0.09, 0.07.
 */
#ifndef SIM_CONSTANTS_H
#define SIM_CONSTANTS_H

typedef struct {
    double branch_n;   /* N, slow force of each elastic branch at 10 mm, before stiffening */
    double relaxation; /* 1, force that relaxes, relative to the slow force */
} sim_calibration;

/* clang-format off */
static const sim_calibration sim_calibrations[5][2] = {
    {{0.805924, 0.955748}, {0.873803, 0.750458}},
    {{1.45373, 0.475474}, {1.51205, 0.393441}},
    {{3.17376, 0.315372}, {3.2507, 0.269756}},
    {{6.16844, 0.177642}, {6.24153, 0.157598}},
    {{6.86148, 0.129528}, {6.9217, 0.115348}},
};
/* clang-format on */

#endif
