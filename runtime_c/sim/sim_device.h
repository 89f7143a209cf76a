/* The haptic device: one moving mass, motor, encoder and load cell. */
#ifndef SIM_DEVICE_H
#define SIM_DEVICE_H

#include "sim_hand.h"
#include "sim_noise.h"
#include "sim_object.h"

#define SIM_ENCODER_STEP_M 10e-6

/* What an encoder of that noise (standard deviation) and step reads for a true position, m. */
double sim_device_encoder_m(sim_noise *noise, double position_m, double noise_m, double step_m);

struct sim_bench {
    sim_object object;
    sim_noise noise;
    uint32_t delay_samples;

    double position_m;
    double velocity_mps;
    double motor_n;      /* N, positive into the object */
    double late_motor_n; /* N, computed but not yet sent, with delay_samples 1 */
    double error_n;      /* N, filtered error of the force, for its derivative */
};

#endif
