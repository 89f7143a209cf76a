/* Deterministic noise: one small generator a state, so that a seed gives one recording. */
#ifndef SIM_NOISE_H
#define SIM_NOISE_H

#include <stdint.h>

typedef struct {
    uint64_t counter;
} sim_noise;

void sim_noise_init(sim_noise *noise, uint64_t seed);

/* A draw of the normal distribution of mean 0 and variance 1. */
double sim_noise_normal(sim_noise *noise);

#endif
