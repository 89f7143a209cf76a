/* springpot 0.1.0 caa8d889b6e129711e4b8e490faf5c2c47d3c054226f74fe5f63b06f84f1df08 */
#include <stddef.h>
#include <string.h>

#include "sp_scene.h"
#include "sp_tables.h"

static const sp_silence_config silence = {
    0.001f,  /* dt_s */
    1000.0f, /* per_dt */
    0.0205f, /* watchdog_s */
};
static const sp_guard_config guard = {
    0.0014693231f, /* jump_m */
    -10.0f,        /* min_m */
    0.119984604f,  /* max_m */
    5,             /* resync_ticks */
};
static const sp_range_config range = {
    0.0f,         /* min_m */
    0.011998461f, /* max_m */
};
static const sp_output_config output = {
    0.0f,       /* min_n */
    10.955592f, /* max_n */
    2.738898f,  /* slew_n */
    0.02f,      /* rise */
    0.1f,       /* back */
    1.369449f,  /* fall_n */
};
static const sp_couple_config couple = {
    1500.0f,                                              /* stiffness_npm */
    20.0f,                                                /* damping_nspm */
    0.00066666666f,                                       /* compliance_mpn */
    0.001f,                                               /* dt_s */
    {0.98684704f, 0.000820096f, -24.60288f, 0.65880865f}, /* phi */
};
static const sp_real per_onset = 8334.402f;

/* A position is true without a history: the object has rested there for ever. */
static void restart(sp_state *state, sp_real position)
{
    const sp_real penetration = position > (sp_real)0 ? position : (sp_real)0;
    const sp_real penetration_u = sp_hammerstein_share(&passive, penetration);
    sp_hammerstein_rest(&passive, &passive_tables, penetration_u,
                        state->penetration_before, state->penetration_held, state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = (sp_real)0;
    sp_tool_velocity_rest(&state->tool_velocity, position);
    sp_couple_release(&state->couple);
    sp_output_restart(&output, &state->output);
}

/* One tick with the tool at `position`; returns the model's force, N. */
SP_APART sp_real tick(sp_state *state, sp_real position, int *notes)
{
    const sp_real position_mps =
        sp_tool_velocity(&state->tool_velocity, rate_hz, velocity_weight, position);
    const sp_real proxy =
        position > (sp_real)0 ? sp_guard_within(&guard, sp_couple_place(&state->couple, position, position_mps)) : position;
    const sp_real penetration = proxy > (sp_real)0 ? proxy : (sp_real)0;
    (void)sp_range_clip(&range, penetration, notes);
    const sp_real penetration_tool = sp_hammerstein_share(&passive, penetration);
    const sp_real penetration_u =
        sp_surface_at(stiffest, passive.n_pieces, &state->penetration_surface, penetration_tool);
    const sp_curve_place penetration_place = sp_curve_at(penetration_u, passive.n_pieces);
    sp_real penetration_branch[4];
    sp_curve(branches, 4, penetration_place, penetration_branch);
    sp_poles_apart(branch_loss, 4,
        penetration_branch, state->penetration_before, state->penetration_held);
    const sp_real penetration_held_n =
        sp_hammerstein_force(&passive, &passive_tables, penetration_u, penetration_place,
                             state->penetration_held, state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = penetration_held_n;
    const sp_real penetration_passive_n =
        penetration_held_n > (sp_real)0 && !(penetration_u > penetration_tool) ? penetration_held_n : (sp_real)0;
    sp_real force = (sp_real)0;
    if (position > (sp_real)0) {
        force = penetration_passive_n;
        force = sp_contact_onset(per_onset, proxy, force);
        force = sp_couple_force(&couple, &state->couple, position, position_mps, force);
    } else {
        sp_couple_release(&state->couple);
        sp_output_free(&state->output);
    }
    return force;
}

/* dt_s have passed without a good sample; share: of the force that may be felt. */
static int hold(sp_state *state, sp_real dt_s, sp_real share, sp_real *force_n)
{
    int notes = SP_NOTE_HELD;
    const sp_real latched = sp_silence_passed(&silence, &state->silence, dt_s);
    sp_real given_n = share * sp_output_clamp(&output, state->output.given_n, &notes);
    state->output.given_n = given_n;
    if (state->silence.latched) {
        notes = 0;
        given_n = sp_output_fall(&output, &state->output, latched, &notes);
    }
    *force_n = given_n;
    return notes;
}

/* The `left` ticks without a sample before this one, a step each. */
SP_RARE void make_up(sp_state *state, sp_real position, sp_real step,
                     sp_real ticks, uint32_t left)
{
    const sp_real begin = state->tool_velocity.velocity_mps * silence.dt_s;
    const sp_real bend = (step - begin) / ticks;
    for (; left > 0; left--) {
        const sp_real curve = bend * (ticks - (sp_real)left);
        const sp_real way = (sp_real)left * (step + curve);
        const sp_real at = sp_guard_within(&guard, position - way);
        int ignored = 0;
        (void)tick(state, at, &ignored);
    }
}

int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_GUARD_BEGUN) {
        return SP_ERROR_STATE;
    }
    uint32_t left = 0;
    sp_real ticks = (sp_real)1;
    if (state->silence.silent_s > (sp_real)0) {
        left = sp_silence_missed(&silence, &state->silence, silence.dt_s);
        ticks = (sp_real)(left + 1);
    }
    (void)velocity_mps;
    int notes = 0;
    const sp_real before = state->guard.good_m;
    const sp_real position =
        sp_guard_position(&guard, &state->guard, ticks, position_m, &notes);
    if (notes & SP_NOTE_HELD) {
        return hold(state, silence.dt_s, sp_guard_share(&guard, &state->guard, position_m), force_n);
    }
    sp_silence_heard(&state->silence, silence.dt_s);
    sp_real way = position - before;
    if (notes & SP_NOTE_RESYNC) {
        restart(state, position);
        left = 0;
        ticks = (sp_real)1;
        way = (sp_real)0;
    }
    if (left > 0) {
        make_up(state, position, way / ticks, ticks, left);
    }
    const sp_real force = tick(state, position, &notes);
    if (state->silence.latched) {
        (void)sp_output_fall(&output, &state->output, (sp_real)1, &notes);
    } else {
        (void)sp_output_force(&output, &state->output, left > 0, (sp_real)1, force, &notes);
    }
    *force_n = state->output.given_n;
    return notes;
}

int sp_run(sp_state *state, uint32_t n, const sp_real *position_m, const sp_real *velocity_mps,
           sp_real *force_n)
{
    if (state == NULL || position_m == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    (void)velocity_mps;
    int notes = 0;
    for (uint32_t i = 0; i < n; i++) {
        notes |= sp_step(state, position_m[i], (sp_real)0, &force_n[i]);
    }
    return notes;
}

int sp_idle(sp_state *state, sp_real dt_s, sp_real *force_n)
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
    return hold(state, dt_s, (sp_real)1, force_n);
}

void sp_init(sp_state *state)
{
    if (state != NULL) {
        (void)memset(state, 0, sizeof *state);
        state->begun = SP_GUARD_BEGUN;
    }
}

void sp_reset(sp_state *state)
{
    sp_init(state);
}

uint32_t sp_abi_version(void)
{
    return 1;
}

uint32_t sp_state_size(void)
{
    return (uint32_t)sizeof(sp_state);
}

const char *sp_manifest(void)
{
    return "{\"springpot\": \"0.1.0\", \"hash\": \"caa8d889b6e129711e4b8e490faf5c2c47d3c054226f74fe5f63b06f84f1df08\", \"scene\": \"proxy\", \"model\": \"hammerstein\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [2.3093100251531682e-07, 0.011998460459983215], \"speed_mps\": 0.18366538639667027, \"force_n\": [-7.121525591458066e-15, 9.129659751043853]}}";
}
