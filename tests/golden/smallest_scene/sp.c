constants of this scene */

static const sp_silence_config sp_scene_silence = {
    0.001f,  /* dt_s */
    1000.0f, /* rate_hz */
    0.0205f, /* watchdog_s */
};
static const sp_guard_config sp_scene_guard = {
    0.001f, /* max_step_m */
    -10.0f, /* min_m */
    0.1f,   /* max_m */
    0.0f,   /* air_m */
    5,      /* resync_ticks */
};
static const sp_range_config sp_scene_range = {
    0.0f,  /* min_m */
    0.01f, /* max_m */
};
static const sp_output_config sp_scene_output = {
    0.0f,  /* min_n */
    12.0f, /* max_n */
    3.0f,  /* slew_n */
    0.02f, /* ramp_per_tick */
    1.5f,  /* latch_fall_n */
};
static const float sp_scene_onset_per_m = 10000.0f;

enum {
    SP_SCENE_N_TAPS = 16,
    SP_SCENE_N_ORDERS = 1
};
/* c(r, k), newest first, 4 and padding: a row each of 0.5. */
static const float sp_scene_taps[1 * 16] = {
    32.0f, -16.0f, -4.0f, -2.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
    0.0f
};

enum {
    SP_SCENE_N_FEATURES = 1
};
static const float sp_scene_leaf_step_n = 0.0001373312f;
static const float sp_scene_forest_bias_n = 1.0f;
/* Sorted thresholds of each feature. */
static const float sp_scene_thresholds[2] = {
    0.02f, 0.06999999f
};
static const uint32_t sp_scene_threshold_starts[2] = {
    0u, 2u
};
/* The first levels of all trees side by side: step, bin (sp_forest.h). */
static const sp_forest_node sp_scene_forest_top[240] = {
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
static const sp_forest_node sp_scene_forest_nodes[17] = {
    {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 21845}, {0, 0}, {0, 0},
    {0, 0}, {0, 65535}, {0, 0}, {0, 0}, {0, 0}, {0, 0}
};
static const uint32_t sp_scene_forest_roots[16] = {
    0u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u, 16u
};
static const sp_forest sp_scene_forest = {
    sp_scene_forest_top,   /* top */
    sp_scene_forest_nodes, /* nodes */
    sp_scene_forest_roots, /* roots */
    1,            /* n_trees */
    16,           /* n_padded */
};

/* ---------------------------------------------------- the tick, and the functions of the header */

/* Restart the history at position_m: the object is taken to have rested there for a long time. */
static void sp_restart_at(sp_state *state, float position_m)
{
    const float penetration_m = position_m > 0.0f ? position_m : 0.0f;
    int ignored_notes = 0;
    const float clipped_m =
        sp_range_clip(&sp_scene_range, penetration_m, &ignored_notes);
    sp_window_fill(state->history, &state->newest, SP_SCENE_N_TAPS, clipped_m);
    sp_output_begin_ramp(&state->output);
}

/* Advance the model by one tick with the tool at position_m. Returns the force before its limits,
 * N, or 0 where only the state is wanted. */
SP_NOINLINE float sp_advance_model(sp_state *state, float position_m, int wants_force, int *notes)
{
    const float penetration_m = position_m > 0.0f ? position_m : 0.0f;
    const float clipped_m = sp_range_clip(&sp_scene_range, penetration_m, notes);
    const float *window =
        sp_window_push(state->history, &state->newest, SP_SCENE_N_TAPS, clipped_m);
    float force_n = 0.0f;
    if (position_m > 0.0f) {
        if (!wants_force) {
            return force_n;
        }
        float features[1];
        sp_taps(sp_scene_taps, window, SP_SCENE_N_TAPS, SP_SCENE_N_ORDERS, features);
        uint32_t bins[SP_FOREST_SLOTS] = {0};
        sp_bins(sp_scene_thresholds, sp_scene_threshold_starts, SP_SCENE_N_FEATURES, features,
                state->bins);
        for (uint32_t i = 0; i < SP_SCENE_N_FEATURES; i++) {
            bins[i + 1] = state->bins[i];
        }
        const uint32_t leaf_sum = sp_forest_sum_simd(&sp_scene_forest, bins, state->simd);
        const float model_n = sp_scene_forest_bias_n + (float)leaf_sum * sp_scene_leaf_step_n;
        force_n = model_n;
        force_n = sp_contact_onset(sp_scene_onset_per_m, position_m, force_n);
    } else {
        sp_output_end_ramp(&state->output);
    }
    return force_n;
}

/* Hold the last force for dt_s without a good sample, scaled by `fraction` (0 .. 1). Once the
 * watchdog has latched, let it fall to zero instead. */
static int sp_hold_force(sp_state *state, float dt_s, float fraction, float *force_n)
{
    int notes = SP_NOTE_HELD;
    const float latched_ticks = sp_silence_no_sample(&sp_scene_silence, &state->silence, dt_s);
    float held_n = fraction * sp_output_clamp(&sp_scene_output, state->output.last_n, &notes);
    state->output.last_n = held_n;
    if (state->silence.latched) {
        notes = 0;
        held_n = sp_output_fall_latched(&sp_scene_output, &state->output, latched_ticks, &notes);
    }
    *force_n = held_n;
    return notes;
}

/* Advance the model through the missed ticks, on a path from the last good position to position_m.
 * step_m: travel per tick. */
SP_COLD void sp_catch_up(sp_state *state, float position_m, float step_m,
                      uint32_t missed_ticks)
{
    for (; missed_ticks > 0; missed_ticks--) {
        const float remaining_m = (float)missed_ticks * step_m;
        const float missed_m = sp_guard_clamp(&sp_scene_guard, position_m - remaining_m);
        int ignored_notes = 0;
        (void)sp_advance_model(state, missed_m, 0, &ignored_notes);
    }
}

/* One tick with a new sample: check the sample, make up for missed ticks, evaluate the model,
 * limit the force. Returns notes or an error. */
int sp_step(sp_state *state, float position_m, float velocity_mps, float *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_STATE_MAGIC) {
        return SP_ERROR_STATE;
    }
    uint32_t missed_ticks = 0;
    float ticks = 1.0f; /* since the last good sample, this one included */
    if (state->silence.silent_s > 0.0f) {
        missed_ticks = sp_silence_missed_ticks(&sp_scene_silence, &state->silence,
                                               sp_scene_silence.dt_s);
        ticks = (float)(missed_ticks + 1);
    }
    (void)velocity_mps;
    int notes = 0;
    const float last_good_m = state->guard.last_good_m;
    const float good_m = sp_guard_accept(&sp_scene_guard, &state->guard, ticks, position_m, &notes);
    if (notes & SP_NOTE_HELD) {
        /* A lone outlier is a read error, such as a 0 at depth: it does not lower the force. */
        const float fraction = state->silence.silent_s > 0.0f
                                     ? sp_guard_held_fraction(&sp_scene_guard, &state->guard,
                                                              position_m)
                                     : 1.0f;
        return sp_hold_force(state, sp_scene_silence.dt_s, fraction, force_n);
    }
    sp_silence_good_sample(&state->silence, sp_scene_silence.dt_s);
    float travel_m = good_m - last_good_m;
    if (notes & SP_NOTE_RESYNC) {
        sp_restart_at(state, good_m);
        missed_ticks = 0;
        ticks = 1.0f;
        travel_m = 0.0f;
    }
    if (missed_ticks > 0) {
        sp_catch_up(state, good_m, travel_m / ticks, missed_ticks);
    }
    const float model_force_n = sp_advance_model(state, good_m, 1, &notes);
    if (state->silence.latched) {
        (void)sp_output_fall_latched(&sp_scene_output, &state->output, 1.0f, &notes);
    } else {
        (void)sp_output_limit(&sp_scene_output, &state->output, 1.0f, model_force_n, &notes);
    }
    *force_n = state->output.last_n;
    return notes;
}

/* Run sp_step over n recorded samples. Returns the notes of all of them. */
int sp_run(sp_state *state, uint32_t n, const float *position_m, const float *velocity_mps,
           float *force_n)
{
    if (state == NULL || position_m == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    (void)velocity_mps;
    int notes = 0;
    for (uint32_t i = 0; i < n; i++) {
        notes |= sp_step(state, position_m[i], 0.0f, &force_n[i]);
    }
    return notes;
}

/* A tick without a new sample: hold the last force, or let it fall once the silence is too
 * long. */
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
    return sp_hold_force(state, dt_s, 1.0f, force_n);
}

/* The ticks of a game's picture, on a straight line to position_m. */
int sp_advance(sp_state *state, float seconds, float position_m, float *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_STATE_MAGIC) {
        return SP_ERROR_STATE;
    }
    if (!(seconds >= 0.0f)) { /* false for NaN */
        return SP_ERROR_TIME_STEP;
    }
    /* A damaged state may hold any remainder. */
    const int whole = sp_abs(state->remainder_s) <= sp_scene_silence.dt_s;
    const float since_s =
        (whole ? state->remainder_s : 0.0f) + (seconds < 1.0f ? seconds : 1.0f);
    /* A thousandth of a tick is added against rounding. */
    const float ticks = since_s / sp_scene_silence.dt_s + (float)0.001;
    const uint32_t n_ticks = ticks > 0.0f ? (uint32_t)ticks : 0u;
    /* A cursor jumps, leaves the screen and goes through walls. The tool behind it stays between
     * a step above the surface and the trained depth, and is no faster than a hand: the guard,
     * which is for a sensor, rejects none of its positions, and no dent is left that takes ten
     * seconds to recover, as of ten trained depths. */
    const float lowest_m = -sp_scene_guard.max_step_m;
    const int known = position_m == position_m;
    float to_m = known ? position_m : state->guard.last_good_m;
    to_m = to_m > lowest_m ? to_m : lowest_m;
    to_m = to_m < sp_scene_range.max_m ? to_m : sp_scene_range.max_m;
    int notes = known ? 0 : SP_NOTE_HELD;
    *force_n = state->output.last_n;
    if (!state->guard.started) { /* a tool that is seen first at depth came from above */
        notes |= sp_step(state, lowest_m, 0.0f, force_n);
    }
    const float from_m = state->guard.last_good_m;
    /* A hundredth less than the guard lets pass, for rounding. */
    const float longest_m = (float)0.99 * sp_scene_guard.max_step_m;
    const float tick_share = since_s > 0.0f ? sp_scene_silence.dt_s / since_s : 0.0f;
    float step_m = (to_m - from_m) * tick_share;
    step_m = step_m < longest_m ? step_m : longest_m;
    step_m = step_m > -longest_m ? step_m : -longest_m;
    for (uint32_t tick = 1; tick <= n_ticks; tick++) {
        notes |= sp_step(state, from_m + (float)tick * step_m, 0.0f, force_n);
    }
    state->remainder_s = since_s - (float)n_ticks * sp_scene_silence.dt_s;
    return notes;
}

/* Begin with an object at rest and untouched. */
void sp_init(sp_state *state)
{
    if (state != NULL) {
        (void)memset(state, 0, sizeof *state);
        state->begun = SP_STATE_MAGIC;
        state->simd = sp_forest_simd();
    }
}

/* Begin anew after a latch or a pause; the site stays. */
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
    return "{\"springpot\": \"0.1.0\", \"hash\": \"a1fb5543ae9ae5951ee701d9f8f15512962082e688c84db162e8d98a8f00f6ab\", \"scene\": \"smallest\", \"model\": \"rf-fd\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [0.0, 0.01], \"speed_mps\": 0.1, \"force_n\": [0.0, 10.0]}}";
}

/* ------------------------------------------------------------------------------------ self-test */

