/* springpot 0.1.0 6c8d0400ad24cd4d314af50f69b21443d983407c78cd768de8a86bdd53cd97d4 */
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
