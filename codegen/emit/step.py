"""The generated calls of a loop: which sample is taken, the ticks up to it, what leaves."""

from springpot.codegen.emit.tick import indented
from springpot.codegen.plan.plan import Plan


def hold() -> str:
    """C function `hold`: sp_idle, and a step whose sample is not taken."""
    lines = [
        "int notes = SP_NOTE_HELD;",
        "const sp_real latched = sp_silence_passed(&silence, &state->silence, dt_s);",
        "sp_real given_n = share * sp_output_clamp(&output, state->output.given_n, &notes);",
        "state->output.given_n = given_n;",
        "if (state->silence.latched) {",
        "    notes = 0;",
        "    given_n = sp_output_fall(&output, &state->output, latched, &notes);",
        "}",
        "*force_n = given_n;",
        "return notes;",
    ]
    head = [
        "/* dt_s have passed without a good sample; share: of the force that may be felt. */",
        "static int hold(sp_state *state, sp_real dt_s, sp_real share, sp_real *force_n)",
    ]
    return "\n".join([*head, "{", *indented(lines), "}"])


def make_up(plan: Plan) -> str:
    """C function `make_up`: the ticks without a sample before this one, `left` of the `ticks`.

    The tool moved evenly; with a coupling's estimate of its velocity at a constant acceleration
    from the velocity before: the damper would feel a kink.
    """
    passed = ", velocity_mps" if plan.needs_device_velocity else ""
    lines = [
        *_bend(plan),
        "for (; left > 0; left--) {",
        *indented(_at(plan)),
        "    int ignored = 0;",
        f"    (void)tick(state, at{passed}, &ignored);",
        "}",
    ]
    head = [
        "/* The `left` ticks without a sample before this one, a step each. */",
        "SP_RARE void make_up(sp_state *state, sp_real position, sp_real step,",
        f"                     {_made_up_by(plan, 'sp_real ')}uint32_t left)",
    ]
    return "\n".join([*head, "{", *indented(lines), "}"])


def _made_up_by(plan: Plan, kind: str) -> str:
    """Pass what else make_up needs: all ticks for a bent way, or the device's own velocity."""
    if plan.velocity is not None:
        return f"{kind}ticks, "
    return f"{kind}velocity_mps, " if plan.needs_device_velocity else ""


def _bend(plan: Plan) -> list[str]:
    if plan.velocity is None:
        return []
    return [
        "const sp_real begin = state->tool_velocity.velocity_mps * silence.dt_s;",
        "const sp_real bend = (step - begin) / ticks;",
    ]


def _at(plan: Plan) -> list[str]:
    if plan.velocity is None:
        return ["const sp_real at = sp_guard_within(&guard, position - (sp_real)left * step);"]
    return [
        "const sp_real curve = bend * (ticks - (sp_real)left);",
        "const sp_real way = (sp_real)left * (step + curve);",
        "const sp_real at = sp_guard_within(&guard, position - way);",
    ]


def step(plan: Plan) -> str:
    """C function sp_step."""
    device = ", velocity_mps" if plan.needs_device_velocity else ""
    lines = [
        *_REFUSED,
        "uint32_t left = 0;",
        "sp_real ticks = (sp_real)1;",
        "if (state->silence.silent_s > (sp_real)0) {",
        "    left = sp_silence_missed(&silence, &state->silence, silence.dt_s);",
        "    ticks = (sp_real)(left + 1);",
        "}",
        *_sample(plan, "silence.dt_s"),
        f"const sp_real force = tick(state, position{device}, &notes);",
        *_leave("(sp_real)1"),
    ]
    head = (
        "int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n)"
    )
    return "\n".join([head, "{", *indented(lines), "}"])


def step_dt(plan: Plan) -> str:
    """C function sp_step_dt: what is longer than a tick is silence before it."""
    lines = [
        *_REFUSED,
        "if (!sp_is_time(dt_s)) {",
        "    return SP_ERROR_TIME_STEP;",
        "}",
        "const sp_real tick_s = dt_s < silence.dt_s ? dt_s : silence.dt_s;",
        "if (dt_s > silence.dt_s) {",
        "    (void)hold(state, dt_s - tick_s, (sp_real)1, force_n);",
        "}",
        "uint32_t left = sp_silence_missed(&silence, &state->silence, tick_s);",
        "sp_real last_s = sp_silence_last(&silence, &state->silence, tick_s, left);",
        "sp_real ticks = (sp_real)left + last_s * silence.per_dt;",
        *_sample(plan, "tick_s"),
        "const sp_real force = tick_dt(state, last_s, position, &notes);",
        *_leave("tick_s * silence.per_dt"),
    ]
    head = (
        "int sp_step_dt(sp_state *state, sp_real dt_s, sp_real position_m, sp_real velocity_mps,\n"
        "               sp_real *force_n)"
    )
    return "\n".join([head, "{", *indented(lines), "}"])


_REFUSED = (
    "if (state == NULL || force_n == NULL) {",
    "    return SP_ERROR_NULL;",
    "}",
    "if (state->begun != SP_GUARD_BEGUN) {",
    "    return SP_ERROR_STATE;",
    "}",
)


def _sample(plan: Plan, tick_s: str) -> list[str]:
    """The sample, taken or not; then the tool's way through the ticks up to it.

    Even; with a coupling at a constant acceleration from the velocity before.
    """
    share = "sp_guard_share(&guard, &state->guard, position_m)" if plan.contact else "(sp_real)1"
    velocity = ["(void)velocity_mps;"]
    if plan.needs_device_velocity:
        velocity = [
            "if (!sp_guard_velocity(max_mps, velocity_mps)) {",
            f"    return hold(state, {tick_s}, {share}, force_n);",
            "}",
        ]
    return [
        *velocity,
        "int notes = 0;",
        "const sp_real before = state->guard.good_m;",
        "const sp_real position =",
        "    sp_guard_position(&guard, &state->guard, ticks, position_m, &notes);",
        "if (notes & SP_NOTE_HELD) {",
        f"    return hold(state, {tick_s}, {share}, force_n);",
        "}",
        f"sp_silence_heard(&state->silence, {tick_s});",
        "sp_real way = position - before;",
        "if (notes & SP_NOTE_RESYNC) {",
        "    restart(state, position);",
        "    left = 0;",
        "    ticks = (sp_real)1;",
        "    way = (sp_real)0;",
        "}",
        "if (left > 0) {",
        f"    make_up(state, position, way / ticks, {_made_up_by(plan, '')}left);",
        "}",
    ]


def _leave(passed: str) -> list[str]:
    """Return what leaves after `passed` ticks."""
    return [
        "if (state->silence.latched) {",
        f"    (void)sp_output_fall(&output, &state->output, {passed}, &notes);",
        "} else {",
        f"    (void)sp_output_force(&output, &state->output, left > 0, {passed}, force, &notes);",
        "}",
        "*force_n = state->output.given_n;",
        "return notes;",
    ]
