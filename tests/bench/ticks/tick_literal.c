/* What the paper's figures and m2cgen give when they are typed in: plain taps over a ring of
 * doubles, nested ifs, Algorithm 1 as printed (with a damping that is stable), a moving average. */
#include <stdint.h>
#include <string.h>

#include "literal_taps.h"

double score(double *features);
int literal_step(void *memory, float position_m, float velocity_mps, float *force_n);
uint32_t literal_size(void);

typedef struct {
    double history[N_TAPS];
    int newest;
    double proxy_m;
    double proxy_mps;
    double smoothed_n;
} literal_state;

uint32_t literal_size(void)
{
    return sizeof(literal_state);
}

int literal_step(void *memory, float position_m, float velocity_mps, float *force_n)
{
    literal_state *state = memory;
    double features[N_ORDERS];
    state->newest = (state->newest + 1) % N_TAPS;
    state->history[state->newest] = position_m;
    for (int order = 0; order < N_ORDERS; order++) {
        features[order] = 0;
        for (int k = 0; k < N_TAPS; k++) {
            features[order] += taps[order][k] * state->history[(state->newest - k + N_TAPS) % N_TAPS];
        }
    }
    const double model_n = score(features);
    const double coupling_n = 1500.0 * (position_m - state->proxy_m) +
                              20.0 * (velocity_mps - state->proxy_mps);
    state->proxy_mps += 0.001 * (coupling_n - model_n) / 0.05;
    state->proxy_m += 0.001 * state->proxy_mps;
    state->smoothed_n = 0.7 * state->smoothed_n + 0.3 * coupling_n;
    *force_n = (float)state->smoothed_n;
    return 0;
}
