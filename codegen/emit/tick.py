"""The generated tick: guard, depth, model, coupling, limits, as a handful of calls."""

import re
from dataclasses import dataclass

from springpot.codegen.plan.plan import Plan
from springpot.codegen.plan.units import measured_stages, stages


def restart(plan: Plan) -> str:
    """C function `restart`: the object has rested at a position for ever."""
    lines = [line for stage in stages(plan) for line in stage.restart()]
    return "\n".join(
        [
            "/* A position is true without a history: the object has rested there for ever. */",
            "static void restart(sp_state *state, sp_real position)",
            "{",
            *_indented([*_depth(plan, "position", lines, "&ignored"), *lines, *_forget(plan)]),
            "    sp_output_restart(&state->output);",
            "}",
        ]
    )


def step(plan: Plan) -> str:
    """C function sp_step: the calls of figure 12, in its order."""
    model = [stage for stage in stages(plan) if stage is not plan.velocity]
    advance = [line for stage in model for line in stage.advance()]
    head = (
        "int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n)"
    )
    lines = [
        "if (state == NULL || force_n == NULL) {",
        "    return SP_ERROR_NULL;",
        "}",
        *_tick(plan, advance, _Names("&guard", "&output", "output.dt_s", "smooth_alpha")),
    ]
    return "\n".join([head, "{", *_indented(lines), "}"])


def step_dt(plan: Plan) -> str:
    """C function sp_step_dt: the limits of a tick, scaled to a measured time step."""
    advance = [line for stage in measured_stages(plan) for line in stage.advance]
    smooth = [
        "const sp_real smooth_steps = dt_s * per_smooth_s;",
        "const sp_real smooth_weight = smooth_steps * sp_measured_phi(smooth_steps);",
    ]
    lines = [
        "if (state == NULL || force_n == NULL) {",
        "    return SP_ERROR_NULL;",
        "}",
        "if (!(dt_s > (sp_real)0 && dt_s <= (sp_real)1)) {",
        "    return SP_ERROR_TIME_STEP;",
        "}",
        "const sp_real steps = dt_s / output.dt_s;",
        "sp_guard_config reach = guard;",
        "sp_output_config limits = output;",
        "reach.jump_m *= steps;",
        "limits.rise *= steps;",
        "limits.slew_n *= steps;",
        "limits.dt_s = dt_s;",
        *(smooth if plan.smooth_alpha is not None else []),
        *_tick(plan, advance, _Names("&reach", "&limits", "dt_s", "smooth_weight")),
    ]
    head = (
        "int sp_step_dt(sp_state *state, sp_real dt_s, sp_real position_m, sp_real velocity_mps,\n"
        "               sp_real *force_n)"
    )
    return "\n".join([head, "{", *_indented(lines), "}"])


@dataclass(frozen=True)
class _Names:
    """C expressions of what depends on the time step."""

    guard: str
    output: str
    dt_s: str
    alpha: str


def _tick(plan: Plan, advance: list[str], names: _Names) -> list[str]:
    return [
        "int notes = 0;",
        f"const sp_real position = sp_guard_position({names.guard}, &state->guard, position_m, "
        "&notes);",
        *_device_velocity(plan),
        f"sp_output_watch({names.output}, &state->output, {names.dt_s}, !(notes & SP_NOTE_HELD));",
        "if (notes & SP_NOTE_RESYNC) {",
        "    restart(state, position);",
        "}",
        *_pressed(plan),
        *advance,
        "sp_real force = (sp_real)0;",
        f"if ({_in_contact(plan)}) {{",
        *_indented([*_model_force(plan), *_shape(plan, names.alpha)]),
        "} else {",
        *_indented([*_forget(plan), "sp_output_free(&state->output);"]),
        "}",
        f"*force_n = sp_output_force({names.output}, &state->output, force, &notes);",
        "return notes;",
    ]


def _model_force(plan: Plan) -> list[str]:
    lines, terms = [], []
    if plan.passive is not None:
        terms.append(f"{plan.passive.follows}_passive_n")
    if plan.features is not None and plan.regressor is not None:
        lines = [
            f"sp_real features[{plan.features.capacity}];",
            *plan.features.read(),
            *plan.regressor.force(),
        ]
        terms.append("model_n")
    if plan.excess is not None:
        terms.append("(penetration_passive_n - clipped_passive_n)")
    return [*lines, f"force = {' + '.join(terms)};"]


def _shape(plan: Plan, alpha: str) -> list[str]:
    lines = []
    if plan.per_fade is not None:
        lines.append(f"force = sp_range_fade(&range, per_fade, {_where(plan)}, force);")
    if plan.contact:
        lines.append(f"force = sp_contact_onset(per_onset, {_where(plan)}, force);")
    if plan.couple is not None:
        if not plan.at_proxy:
            lines.append(f"(void)sp_couple_place(&state->couple, position, {_velocity(plan)});")
        lines.append(
            f"force = sp_couple_force(&couple, &state->couple, position, {_velocity(plan)}, force);"
        )
    if plan.smooth_alpha is not None:
        lines.append(f"force = sp_smooth({alpha}, &state->smoothed_n, force);")
    return lines


def _forget(plan: Plan) -> list[str]:
    lines = []
    if plan.couple is not None:
        lines.append("sp_couple_release(&state->couple);")
    if plan.smooth_alpha is not None:
        lines.append("state->smoothed_n = (sp_real)0;")
    return lines


def _device_velocity(plan: Plan) -> list[str]:
    if not plan.needs_device_velocity:
        return ["(void)velocity_mps;"]
    return [
        "const sp_real device_mps =",
        "    sp_guard_velocity(max_mps, &state->good_mps, velocity_mps, &notes);",
    ]


def _in_contact(plan: Plan) -> str:
    return "position > (sp_real)0" if plan.contact else "state->guard.started"


def _where(plan: Plan) -> str:
    """The variable that the model sees: the tool's position, or the proxy's."""
    return "proxy" if plan.at_proxy else "position"


def _velocity(plan: Plan) -> str:
    return "position_mps" if plan.velocity is not None else "device_mps"


def _pressed(plan: Plan) -> list[str]:
    """Velocity and proxy, where the scene has them; and the depth there."""
    lines = list(plan.velocity.advance()) if plan.velocity is not None else []
    if plan.at_proxy:
        placed = f"sp_couple_place(&state->couple, position, {_velocity(plan)})"
        lines += [
            "const sp_real proxy =",
            f"    {_in_contact(plan)} ? {placed} : position;",
        ]
    model = [stage for stage in stages(plan) if stage is not plan.velocity]
    used = [line for stage in model for line in stage.advance()]
    return [*lines, *_depth(plan, _where(plan), [*used, *_model_force(plan)], "&notes")]


def _depth(plan: Plan, where: str, used_in: list[str], notes: str) -> list[str]:
    """`penetration` into the object, and `clipped` to the trained range: those that are used."""
    uses = [name for name in ("penetration", "clipped") if _mentions(name, used_in)]
    if notes == "&ignored" and not uses:
        return [] if _mentions("position", used_in) else ["(void)position;"]
    lines = []
    if "penetration" in uses or plan.contact:
        minimum = "(sp_real)0" if plan.contact else "range.min_m"
        lines.append(f"const sp_real penetration = {where} > {minimum} ? {where} : {minimum};")
    clip = f"sp_range_clip(&range, {'penetration' if plan.contact else where}, {notes});"
    if "clipped" in uses:
        lines += ["int ignored = 0;"] if notes == "&ignored" else []
        lines.append(f"const sp_real clipped = {clip}")
    elif notes != "&ignored":
        lines.append(f"(void){clip}")
    return lines


def _mentions(name: str, lines: list[str]) -> bool:
    return any(re.search(rf"\b{name}\b", line) for line in lines)


def _indented(lines: list[str]) -> list[str]:
    return ["    " + line if line else line for line in lines]
