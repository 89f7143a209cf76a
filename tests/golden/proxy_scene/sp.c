constants of this scene */

static const sp_silence_config sp_scene_silence = {
    0.001f,  /* dt_s */
    1000.0f, /* rate_hz */
    0.0205f, /* watchdog_s */
};
static const sp_guard_config sp_scene_guard = {
    0.0014693231f, /* max_step_m */
    -10.0f,        /* min_m */
    0.119984604f,  /* max_m */
    -10.0f,        /* air_m */
    5,             /* resync_ticks */
};
static const sp_range_config sp_scene_range = {
    0.0f,         /* min_m */
    0.011998461f, /* max_m */
};
static const sp_output_config sp_scene_output = {
    0.0f,       /* min_n */
    10.955592f, /* max_n */
    2.738898f,  /* slew_n */
    0.02f,      /* ramp_per_tick */
    1.369449f,  /* latch_fall_n */
};
static const sp_couple_config sp_scene_couple = {
    1500.0f,                                 /* stiffness_npm */
    20.0f,                                   /* damping_nspm */
    0.00066666666f,                          /* compliance_mpn */
    0.001f,                                  /* dt_s */
    {0.98684704f, 0.000820096f, -24.60288f, 0.65880865f}, /* phi */
};
static const float sp_scene_onset_per_m = 8334.402f;

/* Curves: values and slopes at the nodes, a column a branch (sp_curve.h). */
static const float sp_scene_spring[20] = {
    0.0f, 0.41273984f, 0.5010738f, 0.58940774f, 1.1820204f, 0.77248544f, 2.044955f, 0.9533838f,
    3.08545f, 1.1276062f, 4.303316f, 1.3081261f, 5.703667f, 1.492576f, 7.28427f, 1.6686296f,
    9.0454645f, 1.8537602f, 9.0454645f, 1.8537602f
};
static const float sp_scene_branches[20 * 4] = {
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.04441721f, 0.01903994f, 0.017259978f, 0.004970012f,
    0.032855902f, 0.019350037f, 0.034519956f, 0.009940024f, 0.02129459f, 0.019660132f, 0.06891983f,
    0.018816372f, 0.04720332f, 0.042240627f, 0.06879976f, 0.017752698f, 0.0074002524f, 0.026121046f,
    0.1536101f, 0.03549022f, 0.05118135f, 0.07128427f, 0.10058078f, 0.0155949965f, 0.0005558048f,
    0.03196625f, 0.26837456f, 0.047015693f, 0.051459253f, 0.10412984f, 0.12894815f, 0.0074559497f,
    0.0f, 0.033724878f, 0.40947756f, 0.050967585f, 0.051459253f, 0.13745369f, 0.15325786f,
    0.0004478369f, 0.0f, 0.03292283f, 0.5730301f, 0.051191505f, 0.051459253f, 0.16970202f,
    0.17384727f, 0.0f, 0.0f, 0.031573843f, 0.75608265f, 0.051191505f, 0.051459253f, 0.19963248f,
    0.19225769f, 0.0f, 0.0f, 0.028287059f, 0.9572059f, 0.051191505f, 0.051459253f, 0.22618717f,
    0.20998879f, 0.0f, 0.0f, 0.024822311f, 0.9572059f, 0.051191505f, 0.051459253f, 0.22618717f,
    0.20998879f, 0.0f, 0.0f, 0.024822311f
};
static const float sp_scene_branch_loss[4] = {
    0.39346933f, 0.07317967f, 0.0114841955f, 0.006145274f
};
/* At most so stiff is each piece of the depth, N a piece (sp_surface.h). */
static const float sp_scene_max_slope_n[9] = {
    0.6748225f, 0.89255923f, 1.1020818f, 1.2977352f, 1.4947548f, 1.6979972f, 1.8891745f, 2.0885715f,
    2.0885715f
};
static const float sp_scene_stops[1 * 20] = {
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.003419151f, 0.006838302f,
    0.015024306f, 0.016372008f, 0.032539934f, 0.018659245f, 0.050479703f, 0.017220294f,
    0.050479703f, 0.017220294f
};
static const float sp_scene_stop_radius[1] = {
    0.5f
};
static const sp_hammerstein_config sp_scene_passive = {
    2.3093101e-07f, /* origin_m */
    83.34563f,      /* u_per_m */
    0.0f,           /* bias_n */
    9,              /* n_intervals */
    4,              /* n_branches */
    1,              /* n_stops */
};
static const sp_hammerstein_tables sp_scene_passive_tables = {
    sp_scene_spring,      /* spring */
    sp_scene_branches,    /* branches */
    sp_scene_stops,       /* stops */
    sp_scene_stop_radius, /* radius */
};

static const float sp_scene_rate_hz = 1000.0f;
static const float sp_scene_velocity_weight = 0.2f;
static const float sp_scene_velocity_lag = 9.0f;

/* ---------------------------------------------------- the tick, and the functions of the header */

/* Restart the history at position_m: the object is taken to have rested there for a long time. */
static void sp_restart_at(sp_state *state, float position_m)
{
    const float penetration_m = position_m > 0.0f ? position_m : 0.0f;
    const float penetration_u = sp_hammerstein_u(&sp_scene_passive, penetration_m);
    sp_hammerstein_rest(&sp_scene_passive, &sp_scene_passive_tables, penetration_u,
                        state->penetration_before, state->penetration_held,
                        state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = 0.0f;
    sp_tool_velocity_rest(&state->tool_velocity, position_m);
    sp_couple_release(&state->couple);
    sp_output_begin_ramp(&state->output);
}

/* Advance the model by one tick with the tool at position_m. Returns the force before its limits,
 * N. */
SP_NOINLINE float sp_advance_model(sp_state *state, float position_m, int *notes)
{
    const float position_mps = sp_tool_velocity(&state->tool_velocity, sp_scene_rate_hz,
                                                sp_scene_velocity_weight, position_m);
    float proxy_m = position_m;
    if (position_m > 0.0f) {
        proxy_m = sp_couple_proxy_position(&state->couple, position_m, position_mps);
        proxy_m = sp_guard_clamp(&sp_scene_guard, proxy_m);
    }
    const float penetration_m = proxy_m > 0.0f ? proxy_m : 0.0f;
    (void)sp_range_clip(&sp_scene_range, penetration_m, notes);
    const float penetration_tool_u = sp_hammerstein_u(&sp_scene_passive, penetration_m);
    const float penetration_u = sp_surface_model_u(sp_scene_max_slope_n,
                                                   sp_scene_passive.n_intervals,
                                                   &state->penetration_surface, penetration_tool_u);
    const sp_curve_position penetration_on_curve =
        sp_curve_locate(penetration_u, sp_scene_passive.n_intervals);
    float penetration_branch[4];
    sp_curve(sp_scene_branches, 4, penetration_on_curve, penetration_branch);
    sp_poles_separate(sp_scene_branch_loss, 4,
        penetration_branch, state->penetration_before, state->penetration_held);
    const float penetration_held_n = sp_hammerstein_force(&sp_scene_passive,
                                                          &sp_scene_passive_tables, penetration_u,
                                                          penetration_on_curve,
                                                          state->penetration_held,
                                                          state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = penetration_held_n;
    const float penetration_passive_n = penetration_held_n > 0.0f &&
        !(penetration_u > penetration_tool_u) ? penetration_held_n : 0.0f;
    float force_n = 0.0f;
    if (position_m > 0.0f) {
        force_n = penetration_passive_n;
        force_n = sp_contact_onset(sp_scene_onset_per_m, proxy_m, force_n);
        force_n = sp_couple_step(&sp_scene_couple, &state->couple, position_m, position_mps,
                                 force_n);
    } else {
        sp_couple_release(&state->couple);
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
                      float ticks, uint32_t missed_ticks)
{
    /* Constant acceleration from the last velocity: on a straight path the coupling's damper would
     * feel a step in velocity. The filtered velocity lags by velocity_lag ticks. */
    const float first_step_m = state->tool_velocity.velocity_mps * sp_scene_silence.dt_s;
    const float step_change_m = (step_m - first_step_m) / (ticks + sp_scene_velocity_lag);
    for (; missed_ticks > 0; missed_ticks--) {
        const float bend_m = step_change_m * (ticks - (float)missed_ticks);
        const float remaining_m = (float)missed_ticks * (step_m + bend_m);
        const float missed_m = sp_guard_clamp(&sp_scene_guard, position_m - remaining_m);
        int ignored_notes = 0;
        (void)sp_advance_model(state, missed_m, &ignored_notes);
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
        sp_catch_up(state, good_m, travel_m / ticks, ticks, missed_ticks);
    }
    const float model_force_n = sp_advance_model(state, good_m, &notes);
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
    return "{\"springpot\": \"0.1.0\", \"hash\": \"1a0c939a561456cc2d81879749feac60568f79930c9197f3061a91c6f9143134\", \"scene\": \"proxy\", \"model\": \"hammerstein\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [2.3093100251531682e-07, 0.011998460459983215], \"speed_mps\": 0.18366538639667027, \"force_n\": [-7.121525591458066e-15, 9.129659751043853]}}";
}

/* ------------------------------------------------------------------------------------ self-test */

