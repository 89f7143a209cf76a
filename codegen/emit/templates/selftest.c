#include <stddef.h>

#include "@PREFIX@_golden.h"
#include "@PREFIX@_scene.h"
@TABLES@
typedef union {
    @BITS@ bits;
    sp_real real;
} pattern;

static sp_real from_bits(@BITS@ bits)
{
    const pattern p = {.bits = bits};
    return p.real;
}
@PROBE@
int sp_selftest(void)
{
    sp_state state;
@FIRST@    sp_init(&state);
    for (size_t i = 0; i < sizeof golden_position / sizeof golden_position[0]; i++) {
        pattern force = {.bits = 0};
        const int notes = sp_step(&state, from_bits(golden_position[i]), @VELOCITY@, &force.real);
        if (force.bits != golden_force[i] || notes != (int)golden_notes[i]) {
            return 1 + (int)i;
        }
    }
    /* A time step that is no number: taken, it would end the watchdog's count for ever. */
    pattern force = {.bits = 0};
    const sp_real no_number = from_bits(@NAN@);
    if (no_number == no_number || sp_idle(&state, no_number, &force.real) != SP_ERROR_TIME_STEP ||
        force.bits != 0) {
        return 1 + (int)(sizeof golden_position / sizeof golden_position[0]);
    }
    return 0;
}
