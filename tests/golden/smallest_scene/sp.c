constants of this scene */

static const sp_silence_config silence = {
    0.001f,  /* dt_s */
    1000.0f, /* rate_hz */
    0.0205f, /* watchdog_s */
};
static const sp_guard_config guard = {
    0.001f, /* max_step_m */
    -10.0f, /* min_m */
    0.1f,   /* max_m */
    0.0f,   /* air_m */
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
    1.5f,  /* fall_n */
};
static const float per_onset = 10000.0f;

enum {
    N_TAPS = 16,
    N_ORDERS = 1
};
/* c(r, k), newest first, 4 and padding: a row each of 0.5. */
static const float taps[1 * 16] = {
    32.0f, -16.0f, -4.0f, -2.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
    0.0f
};

enum {
    N_FEATURES = 1
};
static const float leaf_step_n = 0.0001373312f;
static const float forest_bias_n = 1.0f;
/* Sorted thresholds of each feature. */
static const float thresholds[2] = {
    0.02f, 0.06999999f
};
static const uint32_t threshold_starts[2] = {
    0u, 2u
};
/* The first levels of all trees side by side: step, bin (sp_forest.h). */
static const sp_forest_node forest_top[240] = {
    {1, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {1, 1}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}
};
/* Below, tree after tree. */
static const sp_forest_node forest_nodes[17] = {
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 21845}, {0, 0}, {0, 0},
    {0, 0}, {0, 65535}, {0, 0}, {0, 0}, {0, 0}, {0, 0}
};
static const uint32_t forest_roots[16] = {
    0u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u
};
static const sp_forest forest = {
    forest_top,   /* top */
    forest_nodes, /* nodes */
    forest_roots, /* roots */
    1,            /* n_trees */
    16,           /* n_padded */
};

/* ---------------------------------------------------- the tick, and the functions of the header */

/* A position is true without a history: the object has rested there for ever. */
static void restart(sp_state *state, float position)
{
    const float penetration = position > (float)0 ? position : (float)0;
    int ignored = 0;
    const float clipped = sp_range_clip(&range, penetration, &ignored);
    sp_window_fill(state->history, &state->newest, N_TAPS, clipped);
    sp_output_begin_ramp(&state->output);
}

/* One tick with the tool at `position`; returns the model's force, N. */
SP_NOINLINE float tick(sp_state *state, float position, int *notes)
{
    const float penetration = position > (float)0 ? position : (float)0;
    const float clipped = sp_range_clip(&range, penetration, notes);
    const float *window =
        sp_window_push(state->history, &state->newest, N_TAPS, clipped);
    float force = (float)0;
    if (position > (float)0) {
        float features[1];
        sp_taps(taps, window, N_TAPS, N_ORDERS, features);
        uint32_t bins[SP_FOREST_SLOTS] = {0};
        sp_bins(thresholds, threshold_starts, N_FEATURES, features, state->bins);
        for (uint32_t i = 0; i < N_FEATURES; i++) {
            bins[i + 1] = state->bins[i];
        }
        const uint32_t leaf_sum = sp_forest_sum_simd(&forest, bins, state->simd);
        const float model_n = forest_bias_n + (float)leaf_sum * leaf_step_n;
        force = model_n;
        force = sp_contact_onset(per_onset, position, force);
    } else {
        sp_output_end_ramp(&state->output);
    }
    return force;
}

/* dt_s have passed without a good sample; share: of the force that may be felt. */
static int hold(sp_state *state, float dt_s, float share, float *force_n)
{
    int notes = SP_NOTE_HELD;
    const float latched = sp_silence_no_sample(&silence, &state->silence, dt_s);
    float last_n = share * sp_output_clamp(&output, state->output.last_n, &notes);
    state->output.last_n = last_n;
    if (state->silence.latched) {
        notes = 0;
        last_n = sp_output_fall_latched(&output, &state->output, latched, &notes);
    }
    *force_n = last_n;
    return notes;
}

/* The `left` ticks without a sample before this one, a step each. */
SP_COLD void make_up(sp_state *state, float position, float step,
                     uint32_t left)
{
    for (; left > 0; left--) {
        const float at = sp_guard_clamp(&guard, position - (float)left * step);
        int ignored = 0;
        (void)tick(state, at, &ignored);
    }
}

int sp_step(sp_state *state, float position_m, float velocity_mps, float *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_STATE_MAGIC) {
        return SP_ERROR_STATE;
    }
    uint32_t left = 0;
    float ticks = (float)1;
    if (state->silence.silent_s > (float)0) {
        left = sp_silence_missed_ticks(&silence, &state->silence, silence.dt_s);
        ticks = (float)(left + 1);
    }
    (void)velocity_mps;
    int notes = 0;
    const float before = state->guard.last_good_m;
    const float position =
        sp_guard_accept(&guard, &state->guard, ticks, position_m, &notes);
    if (notes & SP_NOTE_HELD) {
        return hold(state, silence.dt_s, sp_guard_held_fraction(&guard, &state->guard, position_m), force_n);
    }
    sp_silence_good_sample(&state->silence, silence.dt_s);
    float way = position - before;
    if (notes & SP_NOTE_RESYNC) {
        restart(state, position);
        left = 0;
        ticks = (float)1;
        way = (float)0;
    }
    if (left > 0) {
        make_up(state, position, way / ticks, left);
    }
    const float force = tick(state, position, &notes);
    if (state->silence.latched) {
        (void)sp_output_fall_latched(&output, &state->output, (float)1, &notes);
    } else {
        (void)sp_output_limit(&output, &state->output, (float)1, force, &notes);
    }
    *force_n = state->output.last_n;
    return notes;
}

int sp_run(sp_state *state, uint32_t n, const float *position_m, const float *velocity_mps,
           float *force_n)
{
    if (state == NULL || position_m == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    (void)velocity_mps;
    int notes = 0;
    for (uint32_t i = 0; i < n; i++) {
        notes |= sp_step(state, position_m[i], (float)0, &force_n[i]);
    }
    return notes;
}

int sp_idle(sp_state *state, float dt_s, float *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_STATE_MAGIC) {
        return SP_ERROR_STATE;
    }
    if (!sp_is_valid_dt(dt_s)) {
        return SP_ERROR_TIME_STEP;
    }
    return hold(state, dt_s, (float)1, force_n);
}

void sp_init(sp_state *state)
{
    if (state != NULL) {
        (void)memset(state, 0, sizeof *state);
        state->begun = SP_STATE_MAGIC;
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
    return "{\"springpot\": \"0.1.0\", \"hash\": \"4f532c6e51ca4813f208215de67c383191697e32a86521dc0a59cbd4e7a89c5d\", \"scene\": \"smallest\", \"model\": \"rf-fd\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [0.0, 0.01], \"speed_mps\": 0.1, \"force_n\": [0.0, 10.0]}}";
}

/* ------------------------------------------------------------------------------------ self-test */

