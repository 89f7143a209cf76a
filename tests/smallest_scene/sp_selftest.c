/* springpot 0.1.0 c7c26e87fe241efbd59e009a750e83c6598fca6677b7ffb816d2e5796197f0ab */
#include <stddef.h>

#include "sp_golden.h"
#include "sp_scene.h"
#include "sp_tables.h"

typedef union {
    uint32_t bits;
    sp_real real;
} pattern;

static sp_real from_bits(uint32_t bits)
{
    const pattern p = {.bits = bits};
    return p.real;
}

/* Weighted sums of made-up inputs: leaves of trees hide small differences of features. */
static int probe_differs(void)
{
    enum {
        N_INPUTS = N_TAPS < 64 ? N_TAPS : 64
    };
    sp_real in[N_INPUTS];
    pattern out[N_LANES];
    sp_real sums[N_LANES];
    for (uint32_t k = 0; k < N_INPUTS; k++) {
        in[k] = (sp_real)(37 * k % 101) / (sp_real)128;
    }
    sp_weigh(taps, in, N_INPUTS, N_LANES, sums);
    for (uint32_t i = 0; i < N_LANES; i++) {
        out[i].real = sums[i];
        if (out[i].bits != golden_probe[i]) {
            return 1;
        }
    }
    return 0;
}

int sp_selftest(void)
{
    sp_state state;
    if (probe_differs()) {
        return 1;
    }
    sp_init(&state);
    for (size_t i = 0; i < sizeof golden_position / sizeof golden_position[0]; i++) {
        pattern force = {.bits = 0};
        const int notes = sp_step(&state, from_bits(golden_position[i]), (sp_real)0, &force.real);
        if (force.bits != golden_force[i] || notes != (int)golden_notes[i]) {
            return 1 + (int)i;
        }
    }
    return 0;
}
