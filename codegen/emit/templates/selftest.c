static sp_real from_bits(@BITS@ bits)
{
    sp_real number;
    (void)memcpy(&number, &bits, sizeof number);
    return number;
}

static @BITS@ to_bits(sp_real number)
{
    @BITS@ bits;
    (void)memcpy(&bits, &number, sizeof bits);
    return bits;
}
@PROBE@
int sp_selftest(void)
{
    sp_state state;
@FIRST@    sp_init(&state);
    sp_real force_n = (sp_real)0;
    for (size_t i = 0; i < sizeof golden_position / sizeof golden_position[0]; i++) {
@PLACE@        const int notes = sp_step(&state, from_bits(golden_position[i]), @VELOCITY@, &force_n);
        if (to_bits(force_n) != golden_force[i] || notes != (int)golden_notes[i]) {
            return 1 + (int)i;
        }
    }
    /* A time step that is no number: taken, it would end the watchdog's count for ever. */
    force_n = (sp_real)0;
    const sp_real no_number = from_bits(@NAN@);
    if (no_number == no_number || sp_idle(&state, no_number, &force_n) != SP_ERROR_TIME_STEP ||
        to_bits(force_n) != 0) {
        return 1 + (int)(sizeof golden_position / sizeof golden_position[0]);
    }
    /* Too long a silence: no force any more, whatever comes, until a reset. */
    const sp_real deep_m = from_bits(golden_position[@DEEP@]);
    int as_planned = (sp_idle(&state, @LONG@, &force_n) & SP_NOTE_LATCHED) && to_bits(force_n) == 0;
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
