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
    0.02f,      /* rise */
    1.369449f,  /* fall_n */
};
static const sp_couple_config sp_scene_couple = {
    1500.0f,                                              /* stiffness_npm */
    20.0f,                                                /* damping_nspm */
    0.00066666666f,                                       /* compliance_mpn */
    0.001f,                                               /* dt_s */
    {0.98684704f, 0.000820096f, -24.60288f, 0.65880865f}, /* phi */
};
static const float sp_scene_per_onset = 8334.402f;

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
static const float sp_scene_stiffest[9] = {
    0.6748225f, 0.89255923f, 1.1020818f, 1.2977352f, 1.4947548f, 1.6979972f, 1.8891745f, 2.0885715f,
    2.0885715f
};
static const float sp_scene_stops[1 * 20] = {
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.003419151f, 0.006838302f,
    0.015024306f, 0.016372008f, 0.032539934f, 0.018659245f, 0.050479703f, 0.017220294f, 0.050479703f,
    0.017220294f
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

/* A position is true without a history: the object has rested there for ever. */
static void sp_restart(sp_state *state, float position)
{
    const float penetration = position > 0.0f ? position : 0.0f;
    const float penetration_u = sp_hammerstein_u(&sp_scene_passive, penetration);
    sp_hammerstein_rest(&sp_scene_passive, &sp_scene_passive_tables, penetration_u,
                        state->penetration_before, state->penetration_held, state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = 0.0f;
    sp_tool_velocity_rest(&state->tool_velocity, position);
    sp_couple_release(&state->couple);
    sp_output_begin_ramp(&state->output);
}

/* One tick with the tool at `position`; returns the model's force, N. */
SP_NOINLINE float sp_tick(sp_state *state, float position, int *notes)
{
    const float position_mps =
        sp_tool_velocity(&state->tool_velocity, sp_scene_rate_hz, sp_scene_velocity_weight, position);
    const float proxy =
        position > 0.0f ? sp_guard_clamp(&sp_scene_guard, sp_couple_proxy_position(&state->couple, position, position_mps)) : position;
    const float penetration = proxy > 0.0f ? proxy : 0.0f;
    (void)sp_range_clip(&sp_scene_range, penetration, notes);
    const float penetration_tool = sp_hammerstein_u(&sp_scene_passive, penetration);
    const float penetration_u =
        sp_surface_model_u(sp_scene_stiffest, sp_scene_passive.n_intervals, &state->penetration_surface, penetration_tool);
    const sp_curve_position penetration_place = sp_curve_locate(penetration_u, sp_scene_passive.n_intervals);
    float penetration_branch[4];
    sp_curve(sp_scene_branches, 4, penetration_place, penetration_branch);
    sp_poles_separate(sp_scene_branch_loss, 4,
        penetration_branch, state->penetration_before, state->penetration_held);
    const float penetration_held_n =
        sp_hammerstein_force(&sp_scene_passive, &sp_scene_passive_tables, penetration_u, penetration_place,
                             state->penetration_held, state->penetration_play);
    state->penetration_surface.u = penetration_u;
    state->penetration_surface.force_n = penetration_held_n;
    const float penetration_passive_n =
        penetration_held_n > 0.0f && !(penetration_u > penetration_tool) ? penetration_held_n : 0.0f;
    float force = 0.0f;
    if (position > 0.0f) {
        force = penetration_passive_n;
        force = sp_contact_onset(sp_scene_per_onset, proxy, force);
        force = sp_couple_step(&sp_scene_couple, &state->couple, position, position_mps, force);
    } else {
        sp_couple_release(&state->couple);
        sp_output_end_ramp(&state->output);
    }
    return force;
}

/* dt_s have passed without a good sample; share: of the force that may be felt. */
static int sp_hold(sp_state *state, float dt_s, float share, float *force_n)
{
    int notes = SP_NOTE_HELD;
    const float latched = sp_silence_no_sample(&sp_scene_silence, &state->silence, dt_s);
    float last_n = share * sp_output_clamp(&sp_scene_output, state->output.last_n, &notes);
    state->output.last_n = last_n;
    if (state->silence.latched) {
        notes = 0;
        last_n = sp_output_fall_latched(&sp_scene_output, &state->output, latched, &notes);
    }
    *force_n = last_n;
    return notes;
}

/* The `left` ticks without a sample before this one, a step each. */
SP_COLD void sp_make_up(sp_state *state, float position, float step,
                     float ticks, uint32_t left)
{
    /* At a constant acceleration, or the damper would feel a kink. The velocity before is late. */
    const float begin = state->tool_velocity.velocity_mps * sp_scene_silence.dt_s;
    const float bend = (step - begin) / (ticks + sp_scene_velocity_lag);
    for (; left > 0; left--) {
        const float curve = bend * (ticks - (float)left);
        const float way = (float)left * (step + curve);
        const float at = sp_guard_clamp(&sp_scene_guard, position - way);
        int ignored = 0;
        (void)sp_tick(state, at, &ignored);
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
    float ticks = 1.0f;
    if (state->silence.silent_s > 0.0f) {
        left = sp_silence_missed_ticks(&sp_scene_silence, &state->silence, sp_scene_silence.dt_s);
        ticks = (float)(left + 1);
    }
    (void)velocity_mps;
    int notes = 0;
    const float before = state->guard.last_good_m;
    const float position =
        sp_guard_accept(&sp_scene_guard, &state->guard, ticks, position_m, &notes);
    if (notes & SP_NOTE_HELD) {
        return sp_hold(state, sp_scene_silence.dt_s, sp_guard_held_fraction(&sp_scene_guard, &state->guard, position_m), force_n);
    }
    sp_silence_good_sample(&state->silence, sp_scene_silence.dt_s);
    float way = position - before;
    if (notes & SP_NOTE_RESYNC) {
        sp_restart(state, position);
        left = 0;
        ticks = 1.0f;
        way = 0.0f;
    }
    if (left > 0) {
        sp_make_up(state, position, way / ticks, ticks, left);
    }
    const float force = sp_tick(state, position, &notes);
    if (state->silence.latched) {
        (void)sp_output_fall_latched(&sp_scene_output, &state->output, 1.0f, &notes);
    } else {
        (void)sp_output_limit(&sp_scene_output, &state->output, 1.0f, force, &notes);
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
        notes |= sp_step(state, position_m[i], 0.0f, &force_n[i]);
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
    return sp_hold(state, dt_s, 1.0f, force_n);
}

void sp_init(sp_state *state)
{
    if (state != NULL) {
        (void)memset(state, 0, sizeof *state);
        state->begun = SP_STATE_MAGIC;
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
    return "{\"springpot\": \"0.1.0\", \"hash\": \"a6e105d353225ce49cc8a10c9bf28af297978c3b2b0dc7723585e695fbc4f085\", \"scene\": \"proxy\", \"model\": \"hammerstein\", \"si_units\": \"m, m/s, N, s\", \"dt_s\": 0.001, \"number\": \"float32\", \"trained\": {\"depth_m\": [2.3093100251531682e-07, 0.011998460459983215], \"speed_mps\": 0.18366538639667027, \"force_n\": [-7.121525591458066e-15, 9.129659751043853]}}";
}

/* ------------------------------------------------------------------------------------ self-test */

