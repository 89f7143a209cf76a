/* springpot 0.1.0 55c4227d8bae79067de13cb9fd840f263318e50d16e8ced7ef60e871c453d162 */
#include <stddef.h>

#include "sp_golden.h"
#include "sp_scene.h"

typedef union {
    uint32_t bits;
    sp_real real;
} pattern;

static sp_real from_bits(uint32_t bits)
{
    const pattern p = {.bits = bits};
    return p.real;
}

int sp_selftest(void)
{
    sp_state state;
    sp_init(&state);
    for (size_t i = 0; i < sizeof golden_position / sizeof golden_position[0]; i++) {
        pattern force = {.bits = 0};
        (void)sp_step(&state, from_bits(golden_position[i]), (sp_real)0, &force.real);
        if (force.bits != golden_force[i]) {
            return 1 + (int)i;
        }
    }
    return 0;
}
