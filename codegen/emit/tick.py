"""The generated tick: depth, model, coupling, smoothing, as a handful of calls."""

import re

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
            *indented([*_depth(plan, "position", lines, "&ignored"), *lines, *_forget(plan)]),
            "    sp_output_restart(&output, &state->output);",
            "}",
        ]
    )


def take_place(plan: Plan) -> str:
    """C function `take_place` of a scene with places: the object off which the tool is rests."""
    passive = plan.passive
    assert passive is not None
    head = [
        "/* The tool is off the object: the place that waits is taken, and has rested for ever. */",
        "SP_RARE void take_place(sp_state *state)",
    ]
    lines = [f"const sp_real {passive.follows} = (sp_real)0;", *passive.restart()]
    return "\n".join([*head, "{", *indented(lines), "}"])


def tick(plan: Plan) -> str:
    """C function `tick`: the calls of figure 12, in its order."""
    model = [stage for stage in stages(plan) if stage is not plan.velocity]
    advance = [line for stage in model for line in stage.advance()]
    linkage = "SP_APART" if plan.scene.runtime.target == "host" else "static"
    head = [
        "/* One tick with the tool at `position`; returns the model's force, N. */",
        f"{linkage} sp_real tick(sp_state *state, sp_real position{_device(plan)}, int *notes)",
    ]
    return "\n".join([*head, "{", *indented(_tick(plan, advance, "smooth_alpha")), "}"])


def tick_dt(plan: Plan) -> str:
    """C function `tick_dt`: the same over a measured time."""
    advance = [line for stage in measured_stages(plan) for line in stage.advance]
    smooth = ["const sp_real smooth_weight = sp_measured_loss(dt_s * per_smooth_s);"]
    head = [
        "/* The same over dt_s. */",
        "static sp_real tick_dt(sp_state *state, sp_real dt_s, sp_real position, int *notes)",
    ]
    lines = [
        *(smooth if plan.smooth_alpha is not None else []),
        *_tick(plan, advance, "smooth_weight"),
    ]
    return "\n".join([*head, "{", *indented(lines), "}"])


def _tick(plan: Plan, advance: list[str], alpha: str) -> list[str]:
    return [
        *_taken(plan),
        *_pressed(plan),
        *advance,
        "sp_real force = (sp_real)0;",
        f"if ({_in_contact(plan)}) {{",
        *indented([*_model_force(plan), *_shape(plan, alpha)]),
        "} else {",
        *indented([*_forget(plan), "sp_output_free(&state->output);"]),
        "}",
        "return force;",
    ]


def _taken(plan: Plan) -> list[str]:
    if not plan.has_places:
        return []
    waits = f"state->{plan.passive.follows}_map.waits != 0u" if plan.passive else ""
    return [f"if ({waits} && !({_in_contact(plan)})) {{", "    take_place(state);", "}"]


def _device(plan: Plan) -> str:
    return ", sp_real velocity_mps" if plan.needs_device_velocity else ""


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


def _in_contact(plan: Plan) -> str:
    return "position > (sp_real)0" if plan.contact else "state->guard.started"


def _where(plan: Plan) -> str:
    """The variable that the model sees: the tool's position, or the proxy's."""
    return "proxy" if plan.at_proxy else "position"


def _velocity(plan: Plan) -> str:
    return "position_mps" if plan.velocity is not None else "velocity_mps"


def _pressed(plan: Plan) -> list[str]:
    """Velocity and proxy, where the scene has them; and the depth there."""
    model = [stage for stage in stages(plan) if stage is not plan.velocity]
    used = [line for stage in model for line in stage.advance()]
    lines = list(plan.velocity.advance()) if plan.velocity is not None else []
    return [
        *lines,
        *_proxy(plan),
        *_depth(plan, _where(plan), [*used, *_model_force(plan)], "notes"),
    ]


def _proxy(plan: Plan) -> list[str]:
    """Line that declares the proxy's position from contact on; none if the model sees the tool."""
    if not plan.at_proxy:
        return []
    proxy = f"sp_couple_place(&state->couple, position, {_velocity(plan)})"
    placed = f"sp_guard_within(&guard, {proxy})"
    return ["const sp_real proxy =", f"    {_in_contact(plan)} ? {placed} : position;"]


def _depth(plan: Plan, at: str, used_in: list[str], notes: str) -> list[str]:
    """`penetration` into the object, and `clipped` to the trained range: those that are used."""
    uses = [name for name in ("penetration", "clipped") if _mentions(name, used_in)]
    if notes == "&ignored" and not uses:
        return [] if _mentions("position", used_in) else ["(void)position;"]
    lines = []
    if "penetration" in uses or plan.contact:
        minimum = "(sp_real)0" if plan.contact else "range.min_m"
        lines.append(f"const sp_real penetration = {at} > {minimum} ? {at} : {minimum};")
    clip = f"sp_range_clip(&range, {'penetration' if plan.contact else at}, {notes});"
    if "clipped" in uses:
        lines += ["int ignored = 0;"] if notes == "&ignored" else []
        lines.append(f"const sp_real clipped = {clip}")
    elif notes != "&ignored":
        lines.append(f"(void){clip}")
    return lines


def _mentions(name: str, lines: list[str]) -> bool:
    return any(re.search(rf"\b{name}\b", line) for line in lines)


def indented(lines: list[str]) -> list[str]:
    """Lines one level further in."""
    return ["    " + line if line else line for line in lines]
