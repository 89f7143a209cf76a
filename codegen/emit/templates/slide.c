    sp_init(&state);
    for (size_t i = 0; i < sizeof golden_slide_notes; i++) {
        sp_real at[3];
        for (size_t k = 0; k < 3; k++) {
            at[k] = from_bits(golden_slide[3 * i + k]);
        }
        sp_real slid_n[3] = {(sp_real)0, (sp_real)0, (sp_real)0};
        as_planned &= sp_step3(&state, at, NULL, slid_n) == (int)golden_slide_notes[i];
        for (size_t k = 0; k < 3; k++) {
            as_planned &= to_bits(slid_n[k]) == golden_slid[3 * i + k];
        }
        if (!as_planned) {
            return 2 + (int)(sizeof golden_position / sizeof golden_position[0] + i);
        }
    }
