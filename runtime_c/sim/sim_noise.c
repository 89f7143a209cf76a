/* Deterministic noise (sim_noise.h). */
#include "sim_noise.h"

#include <math.h>

void sim_noise_init(sim_noise *noise, uint64_t seed)
{
    noise->counter = seed;
}

/* splitmix64 (Steele, Lea, Flood 2014): any seed will do, neighbours give unrelated streams. */
static uint64_t next_bits(sim_noise *noise)
{
    noise->counter += 0x9e3779b97f4a7c15u;
    uint64_t bits = noise->counter;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    return bits ^ (bits >> 31);
}

/* Uniform in (0, 1): never 0, for the logarithm of 0 would be infinite. */
static double next_uniform(sim_noise *noise)
{
    return ((double)(next_bits(noise) >> 11) + 0.5) * 0x1p-53;
}

double sim_noise_normal(sim_noise *noise)
{
    /* Box and Muller; the second of each pair is not kept: no state beside the counter. */
    const double two_pi = 6.283185307179586;
    double radius = sqrt(-2.0 * log(next_uniform(noise)));
    return radius * cos(two_pi * next_uniform(noise));
}
