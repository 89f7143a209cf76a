#include <stddef.h>

#include "@PREFIX@_golden.h"
#include "@PREFIX@_scene.h"

typedef union {
    @BITS@ bits;
    sp_real real;
} pattern;

static sp_real from_bits(@BITS@ bits)
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
        (void)sp_step(&state, from_bits(golden_position[i]), @VELOCITY@, &force.real);
        if (force.bits != golden_force[i]) {
            return 1 + (int)i;
        }
    }
    return 0;
}
