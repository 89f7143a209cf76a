"""The header of a scene: all that its user needs, and what a state is, to be allocated."""

import re
from functools import cache

import numpy as np

from springpot.codegen.emit.c_text import render_template, split_blocks, strip_comments, wrap_code
from springpot.codegen.literals import c_literal
from springpot.codegen.plan import Plan, list_headers, list_state_members, state_bytes
from springpot.runtime_c.paths import INCLUDE, SOURCE

_PUBLIC = "abi_version|state_size|manifest|init|reset|step|run|idle|advance|place|selftest|state"
_WHOLE_HZ = 1e-6  # a rate nearer to a whole number is one, but for rounding
# What the source includes itself, at its head.
_INCLUDES = re.compile(r'^#include (?:"[^"]*"|<(?:float|math|std\w+|string)\.h>)\n', re.MULTILINE)
_CAST_NUMBER = re.compile(r"\(sp_real\)(\d+(?:\.\d+)?)(?![\w.])")
# Notes and errors are the same for all scenes of a program; a build sets the other two.
_MACRO = re.compile(r"\bSP_(?!NOTE|ERROR|NO_SELFTEST\b|SIMD\b)(\w+)")
_ELSEWHERE = re.compile(r" \((?:see )?flags\.mk\)")


def render_header(plan: Plan) -> str:
    """sp.h for one scene: with its prefix, its number type, its notes and its state."""
    prefix = plan.scene.runtime.prefix
    text = (INCLUDE / "sp.h").read_text(encoding="utf-8")
    for section, kept in (("pictures", plan.draws_pictures), ("places", plan.has_places)):
        before, _, rest = text.partition(f"/* springpot {section} begin */\n")
        inside, _, after = rest.partition(f"/* springpot {section} end */\n")
        text = before + inside * kept + after
    note = render_template(
        "note.txt.j2", prefix=prefix, square_roots="sp_rbf.h" in list_headers(plan)
    )
    notes = (INCLUDE / "sp_notes.h").read_text(encoding="utf-8")
    notes = notes[notes.index("#ifndef") :]
    for pattern, replacement in (
        (r" +\(from sp_scene\.h; on a PC, \w+\(\) bytes\)", ""),
        (r"at the rate that sp_scene\.h and sp_manifest\(\) state", "at the rate SP_RATE_HZ"),
        (r"\(bits in sp_notes\.h\)", "(bits below)"),
        (r"(?= \* Return values: )", note),
        (r'\n#include "sp_notes\.h"\n#include "sp_real.h"\n', f"\n{notes}"),
        (r"(?<=/\* springpot declarations end \*/\n)(?=\n#ifdef)", _render_state(plan)),
    ):
        text, changed = re.subn(pattern, replacement.replace("\\", r"\\"), text)
        assert changed == 1, f"sp.h has no {pattern} any more"
    return wrap_code(apply_prefix(text, prefix, plan.real))


def apply_prefix(text: str, prefix: str, real: str) -> str:
    """Give every name the scene's prefix and number type; sp_NAME.h names a section.

    Numbers that a float holds exactly become literals: (sp_real)0 is 0.0f, or 0.0 in double.
    """

    def as_literal(number: re.Match[str]) -> str:
        if float(np.float32(number[1])) != float(number[1]):
            return number[0]
        return (number[1] if "." in number[1] else f"{number[1]}.0") + "f" * (real == "float")

    text = _CAST_NUMBER.sub(as_literal, text)
    text = _MACRO.sub(rf"{prefix.upper()}_\1", text)
    text = re.sub(r"\bsp_real\b(?!\.h)", real, text)
    return re.sub(r"\bsp_(\w+)\b(?!\.h)", rf"{prefix}_\1", text)


def prefix_public_names(text: str, prefix: str) -> str:
    """Give the public names of sp.h, and only those, the scene's prefix: in the C of a port."""
    return re.sub(rf"\bsp_({_PUBLIC})\b", rf"{prefix}_\1", text)


@cache
def read_unit_blocks(header: str) -> tuple[str, ...]:
    """Blocks of a unit's header, without its guard and its includes."""
    text = (SOURCE / header).read_text(encoding="utf-8")
    guard = header.replace(".", "_").upper()
    text = text.replace(f"#ifndef {guard}\n#define {guard}\n", "").rstrip("\n")
    text = _INCLUDES.sub("", text.removesuffix("#endif"))
    return tuple(split_blocks(_ELSEWHERE.sub("", text)))


def state_types(plan: Plan) -> dict[str, None]:
    """Blocks of the units that define what the state is made of, in order."""
    names = {member.declaration.split()[0] for member in list_state_members(plan)}
    blocks = [block for header in list_headers(plan) for block in read_unit_blocks(header)]
    return {
        block: None
        for block in blocks
        if (last := re.search(r"\} (\w+);$", strip_comments(block).rstrip())) and last[1] in names
    }


def _render_state(plan: Plan) -> str:
    """Render the constants a caller checks its loop against, and the members of sp_state."""
    rate_hz = 1.0 / plan.dt_s
    whole = abs(rate_hz - round(rate_hz)) < _WHOLE_HZ
    numbers = {
        "RATE_HZ": str(round(rate_hz)) if whole else c_literal(plan.dtype(rate_hz)),
        "DT_S": c_literal(plan.silence.dt_s),
        "MAX_FORCE_N": c_literal(plan.output.max_n),
        "TRAINED_DEPTH_M": c_literal(plan.range.max_m),
        "WATCHDOG_S": c_literal(plan.dtype(plan.watchdog_s)),
        "STATE_BYTES": str(state_bytes(plan)),
    }
    return render_template(
        "state.h.j2",
        name=plan.scene.runtime.prefix.upper(),
        whole_hz=int(rate_hz + _WHOLE_HZ),
        numbers=numbers,
        types="\n\n".join(state_types(plan)),
        members=list_state_members(plan),
        bytes=state_bytes(plan),
    )
