/* springpot 0.1.0 e9450291b20558f9423f16bd37bd6ffa5574750fb352ce2f13b7feed6a2bc3cb */
#include <stddef.h>
#include <string.h>

#include "sp_scene.h"
#include "sp_tables.h"
#include "sp_regressor.h"

static const sp_silence_config silence = {
    0.001f,  /* dt_s */
    1000.0f, /* per_dt */
    0.0205f, /* watchdog_s */
};
static const sp_guard_config guard = {
    0.001f, /* jump_m */
    -10.0f, /* min_m */
    0.1f,   /* max_m */
    5,      /* resync_ticks */
};
static const sp_range_config range = {
    0.0f,  /* min_m */
    0.01f, /* max_m */
};
static const sp_output_config output = {
    0.0f,  /* min_n */
    12.0f, /* max_n */
    3.0f,  /* slew_n */
    0.02f, /* rise */
    0.1f,  /* back */
    1.5f,  /* fall_n */
};
static const sp_real per_onset = 10000.0f;

/* A position is true without a history: the object has rested there for ever. */
static void restart(sp_state *state, sp_real position)
{
    const sp_real penetration = position > (sp_real)0 ? position : (sp_real)0;
    int ignored = 0;
    const sp_real clipped = sp_range_clip(&range, penetration, &ignored);
    sp_window_fill(state->history, &state->newest, N_TAPS, clipped);
    sp_output_restart(&output, &state->output);
}

/* One tick with the tool at `position`; returns the model's force, N. */
SP_APART sp_real tick(sp_state *state, sp_real position, int *notes)
{
    const sp_real penetration = position > (sp_real)0 ? position : (sp_real)0;
    const sp_real clipped = sp_range_clip(&range, penetration, notes);
    const sp_real *window =
        sp_window_push(state->history, &state->newest, N_TAPS, clipped);
    sp_real force = (sp_real)0;
    if (position > (sp_real)0) {
        sp_real features[1];
        sp_taps(taps, window, N_TAPS, N_ORDERS, features);
        uint32_t bins[SP_FOREST_SLOTS] = {0};
        sp_bins(thresholds, threshold_starts, N_FEATURES, features, state->bins);
        for (uint32_t i = 0; i < N_FEATURES; i++) {
            bins[i + 1] = state->bins[i];
        }
        const uint32_t leaf_sum = sp_forest_fastest(&forest, bins, state->simd);
        const sp_real model_n = forest_bias_n + (sp_real)leaf_sum * leaf_step_n;
        force = model_n;
        force = sp_contact_onset(per_onset, position, force);
    } else {
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
                     uint32_t left)
{
    for (; left > 0; left--) {
        const sp_real at = sp_guard_within(&guard, position - (sp_real)left * step);
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
        make_up(state, position, way / ticks, left);
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
        state->simd = sp_forest_simd();
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
    return "{\"springpot\": \"0.1.0\", \"hash\": \"e9450291b20558f9423f16bd37bd6ffa5574750fb352ce2f13b7feed6a2bc3cb\", \"scene\": \"smallest\", \"model\": \"rf-fd\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [0.0, 0.01], \"speed_mps\": 0.1, \"force_n\": [0.0, 10.0]}}";
}
