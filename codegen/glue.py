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
    if plan.couple_tool is not None:
        parts.append(struct_text("couple", "sp_couple_tool_config", plan.couple_tool))
    if plan.per_onset is not None:
        parts.append(f"static const sp_real per_onset = {literal(plan.per_onset)};")
    if plan.needs_device_velocity:
        parts.append(f"static const sp_real greatest_mps = {literal(plan.greatest_mps)};")
    if plan.smooth_alpha is not None:
        parts.append(f"static const sp_real smooth_alpha = {literal(plan.smooth_alpha)};")
    return "\n".join(parts)


def _restart(plan: Plan) -> str:
    lines = [line for stage in stages(plan) for line in stage.restart()]
    unused = [] if plan.velocity is not None else ["(void)position;"]
    unused += [] if _goes_deep(plan) else ["(void)deep;"]
    unused += [] if any("depth" in line for line in lines) else ["(void)depth;"]
    return "\n".join(
        [
            "/* A position is true without a history: the object has rested there for ever. */",
            "static void restart(sp_state *state, sp_real position, sp_real deep, sp_real depth)",
            "{",
            *_indented([*unused, *lines, *_forget(plan), "sp_output_restart(&state->output);"]),
            "}",
        ]
    )


def _step(plan: Plan) -> str:
    lines = [
        "if (state == NULL || force_n == NULL) {",
        "    return SP_ERROR_NULL;",
        "}",
        "int notes = 0;",
        "const sp_real position = sp_guard_position(&guard, &state->guard, position_m, &notes);",
        *_device_velocity(plan),
        "sp_output_watch(&output, &state->output, output.dt_s, !(notes & SP_NOTE_HELD));",
        *_depth(plan),
        "if (notes & SP_NOTE_RESYNC) {",
        "    restart(state, position, deep, depth);",
        "}",
        *(line for stage in stages(plan) for line in stage.advance()),
        "sp_real force = (sp_real)0;",
        f"if ({'position > (sp_real)0' if plan.contact else 'state->guard.started'}) {{",
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


def _goes_deep(plan: Plan) -> bool:
    follows = plan.passive.follows if plan.passive is not None else ""
    return plan.excess is not None or follows == "deep"


def _shape(plan: Plan) -> list[str]:
    lines = []
    if plan.contact:
        lines.append("force = sp_contact_onset(per_onset, position, force);")
    if plan.couple_tool is not None:
        velocity = "position_mps" if plan.velocity is not None else "device_mps"
        lines.append(
            f"force = sp_couple_tool_force(&couple, &state->couple, position, {velocity}, force);"
        )
    if plan.smooth_alpha is not None:
        lines.append("force = sp_smooth(smooth_alpha, &state->smoothed_n, force);")
    return lines


def _forget(plan: Plan) -> list[str]:
    lines = []
    if plan.couple_tool is not None:
        lines.append("sp_couple_tool_release(&state->couple);")
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


def _depth(plan: Plan) -> list[str]:
    """`deep`: the position in the object; `depth`: the same within the trained range."""
    least = "(sp_real)0" if plan.contact else "range.least_m"
    source = "deep" if plan.contact else "position"
    return [
        f"const sp_real deep = position > {least} ? position : {least};",
        f"const sp_real depth = sp_range_clip(&range, {source}, &notes);",
    ]


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
