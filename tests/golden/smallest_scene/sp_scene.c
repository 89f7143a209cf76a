/* springpot 0.1.0 abf74fd1ff002b19f0f7c20ff04d91d553b1c284b9b6be567d4f94bcbc4d41ca */
#include <stddef.h>

#include "sp_scene.h"
#include "sp_tables.h"
#include "sp_regressor.h"

static const sp_guard_config guard = {
    .jump_m = 0.001f,
    .min_m = -10.0f,
    .max_m = 0.1f,
    .resync_ticks = 5,
};
static const sp_range_config range = {
    .min_m = 0.0f,
    .max_m = 0.01f,
};
static const sp_output_config output = {
    .min_n = 0.0f,
    .max_n = 12.0f,
    .slew_n = 3.0f,
    .rise = 0.02f,
    .fall_nps = 1500.0f,
    .watchdog_s = 0.02f,
    .dt_s = 0.001f,
};
static const sp_real per_onset = 10000.0f;

/* A position is true without a history: the object has rested there for ever. */
static void restart(sp_state *state, sp_real position)
{
    const sp_real penetration = position > (sp_real)0 ? position : (sp_real)0;
    int ignored = 0;
    const sp_real clipped = sp_range_clip(&range, penetration, &ignored);
    sp_window_fill(state->history, &state->newest, N_TAPS, clipped);
    sp_output_restart(&state->output);
}

int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    int notes = 0;
    const sp_real position = sp_guard_position(&guard, &state->guard, position_m, &notes);
    (void)velocity_mps;
    sp_output_watch(&output, &state->output, output.dt_s, !(notes & SP_NOTE_HELD));
    if (notes & SP_NOTE_RESYNC) {
        restart(state, position);
    }
    const sp_real penetration = position > (sp_real)0 ? position : (sp_real)0;
    const sp_real clipped = sp_range_clip(&range, penetration, &notes);
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
    *force_n = sp_output_force(&output, &state->output, force, &notes);
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
    if (!(sp_is_finite(dt_s) && dt_s > (sp_real)0)) {
        return SP_ERROR_TIME_STEP;
    }
    int notes = 0;
    *force_n = sp_output_idle(&output, &state->output, dt_s, &notes);
    return notes;
}

void sp_init(sp_state *state)
{
    if (state != NULL) {
        *state = (sp_state){0};
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
    return "{\"springpot\": \"0.1.0\", \"hash\": \"abf74fd1ff002b19f0f7c20ff04d91d553b1c284b9b6be567d4f94bcbc4d41ca\", \"scene\": \"smallest\", \"model\": \"rf-fd\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [0.0, 0.01], \"speed_mps\": 0.1, \"force_n\": [0.0, 10.0]}}";
}
