/* springpot 0.1.0 55c4227d8bae79067de13cb9fd840f263318e50d16e8ced7ef60e871c453d162 */
#include <stddef.h>

#include "sp_scene.h"
#include "sp_tables.h"

enum {
    N_TAPS = 4,
    N_LANES = 4,
    N_ORDERS = 1,
    N_ROOTS = 8,
    DEPTH = 3
};
static const sp_guard_config guard = {
    .jump_m = 0.001f,
    .reach_m = 10.0f,
    .resync_ticks = 5,
};
static const sp_range_config range = {
    .least_m = 0.0f,
    .greatest_m = 0.01f,
};
static const sp_output_config output = {
    .least_n = 0.0f,
    .greatest_n = 12.0f,
    .rise = 0.02f,
    .fall_nps = 1500.0f,
    .watchdog_s = 0.02f,
    .dt_s = 0.001f,
};
static const sp_real quantum_n = 9.536743e-07f;
static const sp_real per_onset = 10000.0f;

/* Fractional derivatives of the window -> forest -> force, N. */
static sp_real model_force(const sp_real *window)
{
    sp_real derivative[N_LANES];
    float features[SP_FOREST_SLOTS];
    sp_frac_bank(taps, window, N_TAPS, N_LANES, derivative);
    for (uint32_t i = 0; i < N_ORDERS; i++) {
        features[i] = derivative[i];
    }
    return (sp_real)sp_forest_sum(nodes, roots, N_ROOTS, DEPTH, features) * quantum_n;
}

/* A position taken as true without a history: the object has rested there for ever. */
static void restart(sp_state *state, sp_real position, sp_real depth)
{
    sp_window_fill(state->history, &state->newest, N_TAPS, depth);
    (void)position;
    sp_output_restart(&state->output);
}

int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    int notes = 0;
    const sp_real position =
        sp_guard_position(&guard, &state->guard, position_m, &notes);
    sp_output_watch(&output, &state->output, output.dt_s, !(notes & SP_NOTE_HELD));
    const sp_real depth = sp_range_clip(&range, position, &notes);
    if (notes & SP_NOTE_RESYNC) {
        restart(state, position, depth);
    }
    const sp_real *window =
        sp_window_push(state->history, &state->newest, N_TAPS, depth);
    (void)velocity_mps;
    sp_real force = (sp_real)0;
    if (position > (sp_real)0) {
        force = model_force(window);
        force = sp_contact_onset(per_onset, position, force);
    } else {
        sp_output_free(&state->output);
    }
    *force_n = sp_output_force(&output, &state->output, force, &notes);
    return notes;
}

int sp_run(sp_state *state, uint32_t n, const sp_real *position_m,
           const sp_real *velocity_mps, sp_real *force_n)
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
    return "{\"springpot\": \"0.1.0\", \"hash\": \"55c4227d8bae79067de13cb9fd840f263318e50d16e8ced7ef60e871c453d162\", \"scene\": \"smallest\", \"model\": \"rf-fd\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [0.0, 0.01], \"speed_mps\": 0.1, \"force_n\": [0.0, 10.0]}}";
}
