/* What material r is made of (sp_hammerstein.h). */
static sp_hammerstein_tables material(uint32_t r)
{
    const sp_real *its = materials + r * place_map.n_curves;
    const sp_hammerstein_tables tables = {@TABLES@};
    return tables;
}

/* The object has rested at a depth for ever; the place that is felt is the tool's. */
SP_RARE void restart3(sp_state *state, const sp_real *at)
{
    const sp_real penetration = at[2] > (sp_real)0 ? at[2] : (sp_real)0;
    const sp_real u = sp_hammerstein_share(&passive, penetration);
    for (uint32_t r = 0; r < place_map.n_materials; r++) {
        const sp_hammerstein_tables its = material(r);
        sp_hammerstein_rest(&passive, &its, u, state->lateral_before + r * @CAPACITY@,
                            state->lateral_held + r * @CAPACITY@, @PLAY@);
@SLOW@    }
    state->lateral_surface.u = u;
    state->lateral_surface.force_n = (sp_real)0;
    sp_lateral_rest(&state->lateral, at);
    sp_anchor_rest(&place_map, &state->anchor, at);
}

/* Where the model is while the tool is at `tool`. */
static sp_real surface3(const sp_state *state, sp_real tool)
{
    if (!(tool < state->lateral_surface.u)) {
        return tool;
    }
    sp_lateral_amount here[@MATERIALS@];
    sp_real stiffest[@PIECES@];
    const sp_lateral_cell cell = sp_anchor_cell(&place_map, &state->anchor);
    (void)sp_lateral_amounts(&place_map, &cell, amounts, here);
    sp_lateral_mixed(&place_map, here, materials + @STIFFEST@, @PIECES@, stiffest);
    sp_map_raise(stiffest, @PIECES@, @LEAST@);
    return sp_surface_at(stiffest, @PIECES@, &state->lateral_surface, tool);
}

/* One tick with the tool at x, y and depth; returns the length of the model's force, N. */
SP_APART sp_real tick3(sp_state *state, const sp_real *at, int *notes)
{
    const int inside = at[2] > (sp_real)0;
    const sp_real penetration = inside ? at[2] : (sp_real)0;
    (void)sp_range_clip(&range, penetration, notes);
    if (!inside && sp_anchor_left(&place_map, &state->anchor, at)) {
        restart3(state, at);
    }
    const sp_real tool = sp_hammerstein_share(&passive, penetration);
    const sp_real u = surface3(state, tool);
    const int touches = inside && !(u > tool);
    sp_real moved_m[2];
    sp_anchor_move(&place_map, &anchor, &state->anchor, &state->lateral, amounts,
                   state->lateral_stored, at, touches, moved_m);
    const sp_real share = sp_lateral_move(&state->lateral, at, moved_m, touches);
    const sp_lateral_cell cell = sp_anchor_cell(&place_map, &state->anchor);
    sp_lateral_amount here[@MATERIALS@];
    if (!sp_lateral_amounts(&place_map, &cell, amounts, here)) {
        *notes |= inside ? SP_NOTE_OUTSIDE : 0;
    }
    sp_real takes_j = (sp_real)0;
    for (uint32_t r = 0; r < place_map.n_materials; r++) {
        takes_j += here[r].amount * state->lateral_takes[r];
    }
    const sp_real renewed = sp_drag_afforded(share, state->lateral.paid_j, takes_j);
    for (uint32_t r = 0; r < place_map.n_materials && renewed > (sp_real)0; r++) {
@RENEW@    }
    const sp_curve_place lateral_place = sp_curve_at(u, passive.n_pieces);
    sp_real felt_n[3] = {(sp_real)0, (sp_real)0, (sp_real)0};
    sp_real renewal_j = (sp_real)0;
    sp_real bend_npm = (sp_real)0;
    for (uint32_t r = 0; r < place_map.n_materials; r++) {
        const sp_hammerstein_tables its = material(r);
        sp_real lateral_branch[@CAPACITY@];
        sp_curve(its.branches, @CAPACITY@, lateral_place, lateral_branch);
@STEPS@        const sp_real *held = state->lateral_held + r * @CAPACITY@;
        const sp_real force_n =
            sp_hammerstein_force(&passive, &its, u, lateral_place, held, @PLAY@);
        sp_real renewal;
        const sp_real stored = sp_stored(&passive, &its, areas + r * @AREAS@, lateral_place,
                                         lateral_branch, held, @PLAY@, &renewal);
        const sp_real stored_j = sp_bounded(stored * m_per_piece);
        state->lateral_stored[r] = stored_j;
        sp_lateral_add(here[r], force_n, stored_j, felt_n);
        bend_npm += sp_anchor_bend(&place_map, &cell, amounts, r, stored_j);
        state->lateral_takes[r] = sp_bounded(renewal * m_per_piece);
        renewal_j += here[r].amount * state->lateral_takes[r];
    }
    state->lateral.paid_j = sp_bounded(renewal_j);
    state->lateral_surface.u = u;
    state->lateral_surface.force_n = felt_n[2];
    if (!touches || !(felt_n[2] > (sp_real)0)) {
        state->anchor.touched = 0u; /* the spring lets go where nothing presses it on */
        if (!inside) {
            sp_output_free(&state->output);
        }
        return (sp_real)0;
    }
    state->lateral.renewed = sp_drag_slip(&drag, state->lateral.drawn_m, u, renewal_j, felt_n);
    sp_anchor_feel(&anchor, &state->anchor, bend_npm, felt_n);
    for (uint32_t k = 0; k < 3; k++) {
        felt_n[k] = sp_contact_onset(per_onset, at[2], felt_n[k]);
    }
    return sp_lateral_length(&state->lateral, felt_n);
}

/* dt_s have passed without a good sample; share: of the force that may be felt. */
static int hold3(sp_state *state, sp_real dt_s, sp_real share, sp_real *force_n)
{
    int notes = SP_NOTE_HELD;
    const sp_real latched = sp_silence_passed(&silence, &state->silence, dt_s);
    const sp_real held_n = sp_output_clamp(&output, state->output.given_n, &notes);
    sp_real given_n = share * held_n;
    state->output.given_n = given_n;
    if (state->silence.latched) {
        notes = 0;
        (void)sp_output_fall(&output, &state->output, latched, &notes);
    }
    sp_lateral_give(&state->lateral, state->output.given_n, force_n);
    return notes;
}

/* The `left` ticks without a sample before this one, a step each. */
SP_RARE void make_up3(sp_state *state, const sp_real *position, sp_real ticks, uint32_t left)
{
    sp_real step[3];
    for (uint32_t k = 0; k < 3; k++) {
        step[k] = (position[k] - state->lateral.at_m[k]) / ticks;
    }
    for (; left > 0; left--) {
        const sp_real x_m = position[0] - (sp_real)left * step[0];
        const sp_real y_m = position[1] - (sp_real)left * step[1];
        const sp_real depth_m = position[2] - (sp_real)left * step[2];
        const sp_real at[3] = {sp_guard_within(&lateral_guard, x_m),
                               sp_guard_within(&lateral_guard, y_m),
                               sp_guard_within(&guard, depth_m)};
        int ignored = 0;
        (void)tick3(state, at, &ignored);
    }
}

int sp_step3(sp_state *state, const sp_real position_m[3], const sp_real velocity_mps[3],
             sp_real force_n[3])
{
    (void)velocity_mps;
    if (state == NULL || position_m == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_GUARD_BEGUN) {
        return SP_ERROR_STATE;
    }
    uint32_t left = 0;
    if (state->silence.silent_s > (sp_real)0) {
        left = sp_silence_missed(&silence, &state->silence, silence.dt_s);
    }
    const sp_real ticks = (sp_real)(left + 1);
    int notes = 0;
    const sp_real at[3] = {
        sp_guard_position(&lateral_guard, &state->guard_x, ticks, position_m[0], &notes),
        sp_guard_position(&lateral_guard, &state->guard_y, ticks, position_m[1], &notes),
        sp_guard_position(&guard, &state->guard, ticks, position_m[2], &notes)};
    state->lateral.lost |= notes & SP_NOTE_RESYNC ? 1u : 0u;
    if (notes & SP_NOTE_HELD) {
        sp_guard_state last = state->guard;
        last.good_m = state->lateral.at_m[2];
        return hold3(state, silence.dt_s, sp_guard_share(&guard, &last, position_m[2]), force_n);
    }
    sp_silence_heard(&state->silence, silence.dt_s);
    if (state->lateral.lost != 0u) {
        state->lateral.lost = 0u;
        notes |= SP_NOTE_RESYNC;
        restart3(state, at);
        sp_output_restart(&output, &state->output);
        left = 0;
    }
    sp_real before_n[3];
    sp_lateral_give(&state->lateral, sp_output_clamp(&output, state->output.given_n, &notes),
                    before_n);
    if (left > 0) {
        make_up3(state, at, ticks, left);
    }
    const sp_real length_n = tick3(state, at, &notes);
    if (state->silence.latched) {
        (void)sp_lateral_length(&state->lateral, before_n); /* it falls in its own direction */
        (void)sp_output_fall(&output, &state->output, (sp_real)1, &notes);
    } else {
        const sp_real given_n =
            sp_output_force(&output, &state->output, left > 0, (sp_real)1, length_n, &notes);
        state->output.given_n =
            sp_lateral_grown(&state->lateral, before_n, output.slew_n, given_n, &notes);
    }
    sp_lateral_give(&state->lateral, state->output.given_n, force_n);
    return notes;
}

int sp_idle3(sp_state *state, sp_real dt_s, sp_real force_n[3])
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_GUARD_BEGUN) {
        return SP_ERROR_STATE;
    }
    if (!sp_is_time(dt_s)) {
        return SP_ERROR_TIME_STEP;
    }
    return hold3(state, dt_s, (sp_real)1, force_n);
}
