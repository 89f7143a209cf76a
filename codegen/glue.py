"""The generated C that is not data: state, constants, and the tick as a handful of calls."""

import re
from pathlib import Path

from springpot.codegen.literals import literal, struct_text
from springpot.codegen.plan import Plan
from springpot.codegen.units import planned_headers, state_members
from springpot.runtime_c.paths import INCLUDE

_PUBLIC = "abi_version|state_size|manifest|init|reset|step|run|idle|selftest|state"
ABI_VERSION = 1


def prefixed(text: str, prefix: str) -> str:
    """Give the public names of sp.h (and only those) the scene's prefix."""
    return re.sub(rf"\bsp_({_PUBLIC})\b", rf"{prefix}_\1", text)


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
        f"struct {prefix}_state {{\n{members}\n}};\n\n#endif\n"
    )


def scene_source(plan: Plan, manifest: str) -> str:
    """Constants and the public functions. The tick reads like figure 12 of the paper."""
    prefix = plan.scene.runtime.prefix
    body = "\n\n".join(
        [
            f'#include <stddef.h>\n\n#include "{prefix}_scene.h"\n#include "{prefix}_tables.h"',
            _constants(plan),
            _model_force(plan),
            _restart(plan),
            _step(plan),
            _rest(plan, manifest),
        ]
    )
    return prefixed(body, prefix) + "\n"


def _constants(plan: Plan) -> str:
    parts = [
        f"enum {{\n    N_TAPS = {len(plan.frac.taps)},\n    N_LANES = {plan.frac.taps.shape[1]},\n"
        f"    N_ORDERS = {len(plan.frac.orders)},\n"
        f"    N_ROOTS = {len(plan.forest.roots)},\n    DEPTH = {plan.forest.depth}\n}};",
        struct_text("guard", "sp_guard_config", plan.guard),
        struct_text("range", "sp_range_config", plan.range),
        struct_text("output", "sp_output_config", plan.output),
    ]
    if plan.couple_tool is not None:
        parts.append(struct_text("couple", "sp_couple_tool_config", plan.couple_tool))
    scalars = [("quantum_n", plan.forest.quantum_n)]
    if plan.per_onset is not None:
        scalars.append(("per_onset", plan.per_onset))
    if plan.velocity is not None:
        scalars.append(("velocity_band_m", plan.velocity.band_m))
    if plan.smooth_alpha is not None:
        scalars.append(("smooth_alpha", plan.smooth_alpha))
    lines = [f"static const sp_real {name} = {literal(value)};" for name, value in scalars]
    return "\n".join([*parts, *lines])


def _model_force(plan: Plan) -> str:
    if plan.scene.runtime.forest == "m2cgen":
        slots, total = "N_ORDERS", "(int32_t)forest_score(features)"
        kind = "double"
        cast = "(double)" if plan.real == "float" else "(double)(float)"
    else:
        slots, total = "SP_FOREST_SLOTS", "sp_forest_sum(nodes, roots, N_ROOTS, DEPTH, features)"
        kind = "float"
        cast = "(float)" if plan.real == "double" else ""
    return f"""/* Fractional derivatives of the window -> forest -> force, N. */
static sp_real model_force(const sp_real *window)
{{
    sp_real derivative[N_LANES];
    {kind} features[{slots}];
    sp_frac_bank(taps, window, N_TAPS, N_LANES, derivative);
    for (uint32_t i = 0; i < N_ORDERS; i++) {{
        features[i] = {cast}derivative[i];
    }}
    return (sp_real){total} * quantum_n;
}}"""


def _restart(plan: Plan) -> str:
    lines = [
        "/* A position taken as true without a history: the object has rested there for ever. */",
        "static void restart(sp_state *state, sp_real position, sp_real depth)",
        "{",
        "    sp_window_fill(state->history, &state->newest, N_TAPS, depth);",
    ]
    if plan.velocity is not None:
        length = len(plan.velocity.per_step) + 1
        lines.append(f"    sp_window_fill(state->track, &state->track_newest, {length}, position);")
    else:
        lines.append("    (void)position;")
    lines += ["    " + line for line in _forget(plan)]
    return "\n".join([*lines, "    sp_output_restart(&state->output);", "}"])


def _forget(plan: Plan) -> list[str]:
    lines = []
    if plan.couple_tool is not None:
        lines.append("sp_couple_tool_release(&state->couple);")
    if plan.smooth_alpha is not None:
        lines.append("state->smoothed_n = (sp_real)0;")
    return lines


def _step(plan: Plan) -> str:
    lines = [
        "int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps, sp_real *force_n)",
        "{",
        "    if (state == NULL || force_n == NULL) {",
        "        return SP_ERROR_NULL;",
        "    }",
        "    int notes = 0;",
        "    const sp_real position =",
        "        sp_guard_position(&guard, &state->guard, position_m, &notes);",
        "    sp_output_watch(&output, &state->output, output.dt_s, !(notes & SP_NOTE_HELD));",
        "    const sp_real depth = sp_range_clip(&range, position, &notes);",
        "    if (notes & SP_NOTE_RESYNC) {",
        "        restart(state, position, depth);",
        "    }",
        "    const sp_real *window =",
        "        sp_window_push(state->history, &state->newest, N_TAPS, depth);",
        *_velocity(plan),
    ]
    force = ["force = model_force(window);"]
    if plan.contact:
        force.append("force = sp_contact_onset(per_onset, position, force);")
    if plan.couple_tool is not None:
        force.append(
            "force = sp_couple_tool_force(&couple, &state->couple, position, velocity, force);"
        )
    if plan.smooth_alpha is not None:
        force.append("force = sp_smooth(smooth_alpha, &state->smoothed_n, force);")
    if plan.contact:
        free = [*_forget(plan), "sp_output_free(&state->output);"]
        lines += [
            "    sp_real force = (sp_real)0;",
            "    if (position > (sp_real)0) {",
            *("        " + line for line in force),
            "    } else {",
            *("        " + line for line in free),
            "    }",
        ]
    else:
        lines += ["    sp_real " + force[0], *("    " + line for line in force[1:])]
    lines += [
        "    *force_n = sp_output_force(&output, &state->output, force, &notes);",
        "    return notes;",
        "}",
    ]
    return "\n".join(lines)


def _velocity(plan: Plan) -> list[str]:
    if plan.velocity is not None:
        length = len(plan.velocity.per_step)
        return [
            "    const sp_real *track =",
            f"        sp_window_push(state->track, &state->track_newest, {length + 1}, position);",
            "    const sp_real velocity =",
            f"        sp_velocity_foaw(track, velocity_per_step, {length}, velocity_band_m);",
            "    (void)velocity_mps;",
        ]
    if plan.needs_device_velocity:
        return [
            "    const sp_real velocity =",
            "        sp_guard_velocity(&guard, velocity_mps, output.dt_s, &notes);",
        ]
    return ["    (void)velocity_mps;"]


def _rest(plan: Plan, manifest: str) -> str:
    velocity = "velocity_mps[i]" if plan.needs_device_velocity else "(sp_real)0"
    null = "state == NULL || position_m == NULL || force_n == NULL"
    if plan.needs_device_velocity:
        null += " || velocity_mps == NULL"
        unused = ""
    else:
        unused = "    (void)velocity_mps;\n"
    quoted = manifest.replace("\\", "\\\\").replace('"', '\\"')
    return f"""int sp_run(sp_state *state, uint32_t n, const sp_real *position_m,
           const sp_real *velocity_mps, sp_real *force_n)
{{
    if ({null}) {{
        return SP_ERROR_NULL;
    }}
{unused}    int notes = 0;
    for (uint32_t i = 0; i < n; i++) {{
        notes |= sp_step(state, position_m[i], {velocity}, &force_n[i]);
    }}
    return notes;
}}

int sp_idle(sp_state *state, sp_real dt_s, sp_real *force_n)
{{
    if (state == NULL || force_n == NULL) {{
        return SP_ERROR_NULL;
    }}
    if (!(sp_is_finite(dt_s) && dt_s > (sp_real)0)) {{
        return SP_ERROR_TIME_STEP;
    }}
    int notes = 0;
    *force_n = sp_output_idle(&output, &state->output, dt_s, &notes);
    return notes;
}}

void sp_init(sp_state *state)
{{
    if (state != NULL) {{
        *state = (sp_state){{0}};
    }}
}}

void sp_reset(sp_state *state)
{{
    sp_init(state);
}}

uint32_t sp_abi_version(void)
{{
    return {ABI_VERSION};
}}

uint32_t sp_state_size(void)
{{
    return (uint32_t)sizeof(sp_state);
}}

const char *sp_manifest(void)
{{
    return "{quoted}";
}}"""


def declarations(folder: Path, prefix: str) -> str:
    """Cut the C declarations of an emitted folder out of its headers, for cffi."""
    parts = []
    for header in ("sp_notes.h", f"{prefix}.h"):
        text = (folder / header).read_text()
        begin = text.index("/* springpot declarations begin */")
        parts.append(text[begin : text.index("/* springpot declarations end */")])
    return "\n".join(parts)
