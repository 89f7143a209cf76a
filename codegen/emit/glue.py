"""The generated C that is not data: state, constants, and the tick as a handful of calls."""

import re

from springpot.codegen.emit.project import filled, prefixed
from springpot.codegen.emit.step import hold, make_up, step, step_dt
from springpot.codegen.emit.tick import restart, take_place, tick, tick_dt
from springpot.codegen.literals import constant_text, literal
from springpot.codegen.plan.plan import Plan
from springpot.codegen.plan.units import planned_headers, state_bytes, state_members
from springpot.runtime_c.paths import INCLUDE

ABI_VERSION = 1
_WHOLE_HZ = 1e-6  # a rate nearer to a whole number is one, but for rounding


def public_header(plan: Plan) -> str:
    """sp.h with the scene's prefix and number type: it needs no other header but sp_notes.h."""
    prefix = plan.scene.runtime.prefix
    text = (INCLUDE / "sp.h").read_text()
    text = _part(text, "any rate", plan.any_rate)
    text = _part(text, "places", plan.has_places)
    text = text.replace('#include "sp_real.h"\n', "").replace("sp_scene.h", f"{prefix}_scene.h")
    text = re.sub(r"\bsp_real\b", plan.real, text)
    text = re.sub(r"\bSP_H\b", f"{prefix.upper()}_H", text)
    return prefixed(text, prefix)


def _part(text: str, name: str, kept: bool) -> str:
    """The header with or without a part that only some scenes have."""
    begin, end = f"/* springpot {name} begin */\n", f"/* springpot {name} end */\n"
    before, _, rest = text.partition(begin)
    inside, _, after = rest.partition(end)
    return before + (inside if kept else "") + after


def scene_header(plan: Plan) -> str:
    """Definition of the state, for whoever allocates it statically."""
    prefix = plan.scene.runtime.prefix
    guard = f"{prefix.upper()}_SCENE_H"
    includes = "\n".join(f'#include "{header}"' for header in planned_headers(plan))
    members = "\n".join(f"    {member.declaration};" for member in state_members(plan))
    return (
        f"#ifndef {guard}\n#define {guard}\n\n"
        f'#include <stdint.h>\n\n#include "{prefix}.h"\n#include "sp_real.h"\n{includes}\n\n'
        f"{scene_numbers(plan)}\n"
        f"/* {plan.scene.name}: what one tick hands to the next. */\n"
        f"struct {prefix}_state {{\n{members}\n}};\n\n"
        "/* Fails where a header of another number type or version was included first. */\n"
        f"typedef char {prefix}_state_is_as_planned"
        f"[sizeof(struct {prefix}_state) == {state_bytes(plan)} ? 1 : -1];\n\n#endif\n"
    )


def scene_numbers(plan: Plan) -> str:
    """What a caller can hold against its own loop and device: a rate, a depth, a force, bytes."""
    name = plan.scene.runtime.prefix.upper()
    rate_hz = 1.0 / plan.dt_s
    whole = abs(rate_hz - round(rate_hz)) < _WHOLE_HZ
    numbers = {
        "RATE_HZ": str(round(rate_hz)) if whole else literal(plan.dtype(rate_hz)),
        "DT_S": literal(plan.silence.dt_s),
        "MAX_FORCE_N": literal(plan.output.max_n),
        "TRAINED_DEPTH_M": literal(plan.range.max_m),
        "WATCHDOG_S": literal(plan.dtype(plan.watchdog_s)),
        "STATE_BYTES": str(state_bytes(plan)),
    }
    defines = "".join(f"#define {name}_{key} {value}\n" for key, value in numbers.items())
    return (
        "/* A loop can check that the scene was made for it:\n"
        f" * _Static_assert((int){name}_RATE_HZ == {int(rate_hz + _WHOLE_HZ)}, "
        '"emit the scene with the rate of this loop"); */\n'
        f"{defines}"
    )


def scene_source(plan: Plan, manifest: str) -> str:
    """Constants and the public functions. The tick reads like figure 12 of the paper."""
    prefix = plan.scene.runtime.prefix
    headers = [f"{prefix}_scene.h", f"{prefix}_tables.h"]
    headers += [f"{prefix}_regressor.h"] if plan.regressor is not None else []
    includes = "\n".join(f'#include "{header}"' for header in headers)
    head = f"#include <stddef.h>\n#include <string.h>\n\n{includes}"
    return prefixed("\n\n".join([head, constants(plan), *functions(plan, manifest)]), prefix)


def functions(plan: Plan, manifest: str) -> list[str]:
    """All functions of a scene, those of the loop first; manifest: JSON that the image holds."""
    return [
        restart(plan),
        *([take_place(plan)] if plan.has_places else []),
        tick(plan),
        *([tick_dt(plan)] if plan.any_rate else []),
        hold(),
        make_up(plan),
        step(plan),
        *([step_dt(plan)] if plan.any_rate else []),
        *([_place(plan)] if plan.has_places else []),
        _api(plan, manifest),
    ]


def constants(plan: Plan) -> str:
    """C constants that the scene itself fixes: limits, gains, rates."""
    per_smooth_s = None
    if plan.smooth_alpha is not None and plan.any_rate:
        per_smooth_s = plan.dtype(1.0 / plan.scene.smoothing.time_constant_s)
    found = {
        "silence": plan.silence,
        "guard": plan.guard,
        "range": plan.range,
        "output": plan.output,
        "couple": plan.couple,
        "per_onset": plan.per_onset,
        "per_fade": plan.per_fade,
        "max_mps": plan.max_mps if plan.needs_device_velocity else None,
        "smooth_alpha": plan.smooth_alpha,
        "per_smooth_s": per_smooth_s,
    }
    return "\n".join(constant_text(*item) for item in found.items() if item[1] is not None)


def _place(plan: Plan) -> str:
    """C function sp_place."""
    assert plan.passive is not None
    lines = [
        "void sp_place(sp_state *state, sp_real x_m, sp_real y_m)",
        "{",
        "    if (state != NULL) {",
        f"        sp_map_place(&place_map, &state->{plan.passive.follows}_map, x_m, y_m);",
        "    }",
        "}",
    ]
    return "\n".join(lines)


def _api(plan: Plan, manifest: str) -> str:
    needs = plan.needs_device_velocity
    init = plan.regressor.init() if plan.regressor is not None else []
    kept, again = [], []
    if plan.passive is not None and plan.passive.placed is not None:
        start = ", ".join(literal(plan.dtype(at)) for at in plan.passive.placed.start_m)
        of_map = f"state->{plan.passive.follows}_map"
        init = [f"sp_map_place(&place_map, &{of_map}, {start});", f"{of_map}.waits = 1u;",
                "take_place(state);"]  # fmt: skip
        kept = [
            "sp_map_state place = {(sp_real)0, (sp_real)0, 0u};",
            "const int begun = state != NULL && state->begun == SP_GUARD_BEGUN;",
            "if (begun) {",
            f"    place = {of_map};",
            "}",
        ]
        again = ["if (begun) {", f"    {of_map} = place;", f"    {of_map}.waits = 1u;",
                 "    take_place(state);", "}"]  # fmt: skip
    return filled(
        "api.c",
        plan,
        NULLS=" || velocity_mps == NULL" if needs else "",
        UNUSED="" if needs else "    (void)velocity_mps;\n",
        VELOCITY="velocity_mps[i]" if needs else "(sp_real)0",
        ABI=str(ABI_VERSION),
        INIT="".join(f"        {line}\n" for line in init),
        KEPT="".join(f"    {line}\n" for line in kept),
        AGAIN="".join(f"    {line}\n" for line in again),
        MANIFEST=manifest.replace("\\", "\\\\").replace('"', '\\"'),
    )
