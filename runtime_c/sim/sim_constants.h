/* Written by tests/bench/calibrate_sim.py: do not edit. For each object and variant (A, B), what
 * gives Table 1's maximum depth over the training protocol, and a loss per cycle at 1 Hz and 10 N
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
    {{0.841567, 1.09369}, {0.887976, 0.982456}},
    {{1.4833, 0.56537}, {1.52102, 0.524208}},
    {{3.21216, 0.382962}, {3.26487, 0.365993}},
    {{6.20537, 0.221488}, {6.25966, 0.216783}},
    {{6.89902, 0.161907}, {6.94, 0.15948}},
};
/* clang-format on */

#endif
