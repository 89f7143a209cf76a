"""The generated C that is not data: state, constants, and the tick as a handful of calls."""

import re
from pathlib import Path

from springpot.codegen.literals import literal, struct_text
from springpot.codegen.plan import Plan
from springpot.codegen.project import filled, prefixed
from springpot.codegen.units import planned_headers, stages, state_bytes, state_members
from springpot.runtime_c.paths import INCLUDE

ABI_VERSION = 1


def public_header(plan: Plan) -> str:
    """sp.h with the scene's prefix and number type: it needs no other header but sp_notes.h."""
    prefix = plan.scene.runtime.prefix
    text = (INCLUDE / "sp.h").read_text()
    text = text.replace('#include "sp_real.h"\n', "").replace("sp_scene.h", f"{prefix}_scene.h")
    text = re.sub(r"\bsp_real\b", plan.real, text)
    text = re.sub(r"\bSP_H\b", f"{prefix.upper()}_H", text)
    return prefixed(text, prefix)


def scene_header(plan: Plan) -> str:
    """Definition of the state, for whoever allocates it statically."""
    prefix = plan.scene.runtime.prefix
    guard = f"{prefix.upper()}_SCENE_H"
    includes = "\n".join(f'#include "{header}"' for header in planned_headers(plan))
    members = "\n".join(f"    {member.declaration};" for member in state_members(plan))
    return (
        f"#ifndef {guard}\n#define {guard}\n\n"
        f'#include <stdint.h>\n\n#include "{prefix}.h"\n#include "sp_real.h"\n{includes}\n\n'
        f"/* {plan.scene.name}: what one tick hands to the next. */\n"
        f"struct {prefix}_state {{\n{members}\n}};\n\n"
        "/* Fails where a header of another number type or version was included first. */\n"
        f"typedef char {prefix}_state_is_as_planned"
        f"[sizeof(struct {prefix}_state) == {state_bytes(plan)} ? 1 : -1];\n\n#endif\n"
    )


def scene_source(plan: Plan, manifest: str) -> str:
    """Constants and the public functions. The tick reads like figure 12 of the paper."""
    prefix = plan.scene.runtime.prefix
    parts = [
        f'#include <stddef.h>\n\n#include "{prefix}_scene.h"\n#include "{prefix}_tables.h"'
        + (f'\n#include "{prefix}_regressor.h"' if plan.regressor is not None else ""),
        _constants(plan),
        _restart(plan),
        _step(plan),
        _api(plan, manifest),
    ]
    return prefixed("\n\n".join(parts), prefix)


def _constants(plan: Plan) -> str:
    parts = [
        struct_text("guard", "sp_guard_config", plan.guard),
        struct_text("range", "sp_range_config", plan.range),
        struct_text("output", "sp_output_config", plan.output),
    ]
    if plan.couple is not None:
        parts.append(struct_text("couple", "sp_couple_config", plan.couple))
    if plan.per_onset is not None:
        parts.append(f"static const sp_real per_onset = {literal(plan.per_onset)};")
    if plan.per_fade is not None:
        parts.append(f"static const sp_real per_fade = {literal(plan.per_fade)};")
    if plan.needs_device_velocity:
        parts.append(f"static const sp_real greatest_mps = {literal(plan.greatest_mps)};")
    if plan.smooth_alpha is not None:
        parts.append(f"static const sp_real smooth_alpha = {literal(plan.smooth_alpha)};")
    return "\n".join(parts)


def _restart(plan: Plan) -> str:
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


def _step(plan: Plan) -> str:
    model = [stage for stage in stages(plan) if stage is not plan.velocity]
    lines = [
        "if (state == NULL || force_n == NULL) {",
        "    return SP_ERROR_NULL;",
        "}",
        "int notes = 0;",
        "const sp_real position = sp_guard_position(&guard, &state->guard, position_m, &notes);",
        *_device_velocity(plan),
        "sp_output_watch(&output, &state->output, output.dt_s, !(notes & SP_NOTE_HELD));",
        "if (notes & SP_NOTE_RESYNC) {",
        "    restart(state, position);",
        "}",
        *_pressed(plan),
        *(line for stage in model for line in stage.advance()),
        "sp_real force = (sp_real)0;",
        f"if ({_in_contact(plan)}) {{",
        *_indented([*_model_force(plan), *_shape(plan)]),
        "} else {",
        *_indented([*_forget(plan), "sp_output_free(&state->output);"]),
        "}",
        "*force_n = sp_output_force(&output, &state->output, force, &notes);",
        "return notes;",
    ]
    head = (
        "int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n)"
    )
    return "\n".join([head, "{", *_indented(lines), "}"])


def _model_force(plan: Plan) -> list[str]:
    lines, terms = [], []
    if plan.passive is not None:
        terms.append(f"{plan.passive.follows}_passive_n")
    if plan.features is not None and plan.regressor is not None:
        lines = [
            f"sp_real features[{plan.features.room}];",
            *plan.features.read(),
            *plan.regressor.force(),
        ]
        terms.append("model_n")
    if plan.excess is not None:
        terms.append("(deep_passive_n - depth_passive_n)")
    return [*lines, f"force = {' + '.join(terms)};"]


def _shape(plan: Plan) -> list[str]:
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
        lines.append("force = sp_smooth(smooth_alpha, &state->smoothed_n, force);")
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
        "    sp_guard_velocity(greatest_mps, &state->good_mps, velocity_mps, &notes);",
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
    """`deep`: how far in the object; `depth`: the same within the trained range; where used."""
    uses = [name for name in ("deep", "depth") if _mentions(name, used_in)]
    if notes == "&ignored" and not uses:
        return [] if _mentions("position", used_in) else ["(void)position;"]
    lines = []
    if "deep" in uses or plan.contact:
        least = "(sp_real)0" if plan.contact else "range.least_m"
        lines.append(f"const sp_real deep = {where} > {least} ? {where} : {least};")
    clip = f"sp_range_clip(&range, {'deep' if plan.contact else where}, {notes});"
    if "depth" in uses:
        lines += ["int ignored = 0;"] if notes == "&ignored" else []
        lines.append(f"const sp_real depth = {clip}")
    elif notes != "&ignored":
        lines.append(f"(void){clip}")
    return lines


def _mentions(name: str, lines: list[str]) -> bool:
    return any(re.search(rf"\b{name}\b", line) for line in lines)


def _api(plan: Plan, manifest: str) -> str:
    needs = plan.needs_device_velocity
    init = plan.regressor.init() if plan.regressor is not None else []
    return filled(
        "api.c",
        plan,
        NULLS=" || velocity_mps == NULL" if needs else "",
        UNUSED="" if needs else "    (void)velocity_mps;\n",
        VELOCITY="velocity_mps[i]" if needs else "(sp_real)0",
        ABI=str(ABI_VERSION),
        INIT="".join(f"        {line}\n" for line in init),
        MANIFEST=manifest.replace("\\", "\\\\").replace('"', '\\"'),
    )


def _indented(lines: list[str]) -> list[str]:
    return ["    " + line if line else line for line in lines]


def declarations(folder: Path, prefix: str) -> str:
    """Cut the C declarations of an emitted folder out of its headers, for cffi."""
    parts = []
    for header in ("sp_notes.h", f"{prefix}.h"):
        text = (folder / header).read_text()
        begin = text.index("/* springpot declarations begin */")
        parts.append(text[begin : text.index("/* springpot declarations end */")])
    return "\n".join(parts)
