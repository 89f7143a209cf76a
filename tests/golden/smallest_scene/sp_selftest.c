/* springpot 0.1.0 e9450291b20558f9423f16bd37bd6ffa5574750fb352ce2f13b7feed6a2bc3cb */
#include <stddef.h>
#include <string.h>

#include "sp_golden.h"
#include "sp_scene.h"
#include "sp_tables.h"

static sp_real from_bits(uint32_t bits)
{
    sp_real number;
    (void)memcpy(&number, &bits, sizeof number);
    return number;
}

static uint32_t to_bits(sp_real number)
{
    uint32_t bits;
    (void)memcpy(&bits, &number, sizeof bits);
    return bits;
}

/* Sums of made-up inputs: leaves of trees hide small differences of features. */
static int probe_differs(void)
{
    sp_real in[16];
    sp_real sums[1];
    for (uint32_t k = 0; k < 16; k++) {
        in[k] = (sp_real)(37 * k % 101) / (sp_real)128;
    }
    sp_taps(taps, in, N_TAPS, N_ORDERS, sums);
    for (uint32_t i = 0; i < 1; i++) {
        if (to_bits(sums[i]) != golden_probe[i]) {
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
    sp_real force_n = (sp_real)0;
    for (size_t i = 0; i < sizeof golden_position / sizeof golden_position[0]; i++) {
        const int notes = sp_step(&state, from_bits(golden_position[i]), (sp_real)0, &force_n);
        if (to_bits(force_n) != golden_force[i] || notes != (int)golden_notes[i]) {
            return 1 + (int)i;
        }
    }
    /* A time step that is no number: taken, it would end the watchdog's count for ever. */
    force_n = (sp_real)0;
    const sp_real no_number = from_bits(0x7fc00000u);
    if (no_number == no_number || sp_idle(&state, no_number, &force_n) != SP_ERROR_TIME_STEP ||
        to_bits(force_n) != 0) {
        return 1 + (int)(sizeof golden_position / sizeof golden_position[0]);
    }
    /* Too long a silence: no force any more, whatever comes, until a reset. */
    const sp_real deep_m = from_bits(golden_position[180]);
    int as_planned = (sp_idle(&state, 0.072f, &force_n) & SP_NOTE_LATCHED) && to_bits(force_n) == 0;
    as_planned &= (sp_step(&state, deep_m, (sp_real)0, &force_n) & SP_NOTE_LATCHED) != 0;
    as_planned &= to_bits(force_n) == 0;
    sp_reset(&state);
    const sp_real first_m = from_bits(golden_position[0]);
    as_planned &= sp_step(&state, first_m, (sp_real)0, &force_n) == (int)golden_notes[0];
    if (!as_planned) {
        return 1 + (int)(sizeof golden_position / sizeof golden_position[0]);
    }
    return 0;
}
