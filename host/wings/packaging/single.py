"""A scene as one source and one header that any project can take, in C11 and in C++17.

The same C as in many files: units without what this scene calls nothing of, constants, the tick,
the self-test. Every name that the header declares carries the scene's prefix.
"""

import re
from collections.abc import Mapping
from functools import cache
from typing import Any

from springpot.emission import (
    Plan,
    constants,
    filled,
    functions,
    golden_arrays,
    hashed,
    manifest_text,
    planned_headers,
    public_header,
    regressor_tables,
    scene_numbers,
    selftest,
    short_manifest_text,
    stage_tables,
    stamp,
    state_bytes,
    state_members,
)
from springpot.host.wings.packaging.c_blocks import code_of, top_level_blocks, without_unused
from springpot.host.wings.packaging.library import (
    PACKAGE,
    arduino_properties,
    arduino_sketch,
    platformio_manifest,
)
from springpot.native import INCLUDE, SOURCE

_WIDTH = 100
_MANIFEST = "@IMAGE@"
# What gcc says of a forest's traversal at some levels of optimisation, and without reason.
_QUIET = """/* No warning of what gcc's own intrinsics leave undefined on purpose, and convert
 * where they are macros; nor of the places of trees that are never there. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wsign-conversion"
"""
_LOUD = "#pragma GCC diagnostic pop\n"
# What the source includes itself, at its head.
_INCLUDES = re.compile(r'^#include (?:"[^"]*"|<(?:float|math|std\w+|string)\.h>)\n', re.MULTILINE)
_ANALYSIS = re.compile(r"^ *//@.*\n", re.MULTILINE)  # notes for the proof alone
_ELSEWHERE = re.compile(r" \((?:see )?flags\.mk\)")


def emit_single(plan: Plan, facts: Mapping[str, Any] | None = None) -> dict[str, str]:
    """Return file name -> text: source, header, examples, metadata of libraries, manifest.

    facts: as of `emit_files`.
    """
    prefix = plan.scene.runtime.prefix
    files = {
        f"{prefix}.h": single_header(plan),
        f"{prefix}.c": single_source(plan),
        f"examples/{prefix}_loop/{prefix}_loop.ino": arduino_sketch(plan),
        f"examples/{prefix}_lines/main.c": filled("main.c", plan, HEADER=f"{prefix}.h"),
    }
    files = {name: stamp(name) + text for name, text in files.items()}
    files["library.properties"] = arduino_properties(plan)
    files["library.json"] = platformio_manifest(plan)
    files["manifest.json"] = manifest_text(plan, facts or {}, [f"{prefix}.c"])
    return hashed(files) | {f"{prefix}.def": exported_names(plan)}


def exported_names(plan: Plan) -> str:
    """Return a module definition: what Visual Studio's linker lets others call of a DLL."""
    called = rf"^[a-z].*?\b({plan.scene.runtime.prefix}_\w+)\("
    names = re.findall(called, single_header(plan), re.MULTILINE)
    return "EXPORTS\n" + "".join(f"    {name}\n" for name in names)


def single_header(plan: Plan) -> str:
    """Everything that a user of the scene needs, and what a state is, to be allocated."""
    prefix = plan.scene.runtime.prefix
    text = public_header(plan)
    for place, replacement in (
        (r" +\(from \w+_scene\.h; on a PC, \w+\(\) bytes\)", ""),
        (r"\(bits, in sp_notes\.h\)", "(bits, below)"),
        (
            r"(?= \* What a call returns)",
            filled("single_note.txt", plan, PACKAGE, LIBRARY=_library(plan)),
        ),
        (r'\n#include "sp_notes\.h"\n', f"\n{_notes()}"),
        (r"(?<=/\* springpot declarations end \*/\n)(?=\n#ifdef)", _state(plan)),
    ):
        text, changed = re.subn(place, replacement.replace("\\", r"\\"), text)
        assert changed == 1, f"sp.h has no {place} any more"
    return _renamed(text, prefix, plan.real)


def single_source(plan: Plan) -> str:
    """C of the whole scene, in the order of a tick."""
    prefix = plan.scene.runtime.prefix
    kept = _state_types(plan)
    parts = [_rule("sp_real.h"), _numbers(plan.real)]
    for header in planned_headers(plan):
        parts += [_rule(header), *(block for block in _unit(header) if block not in kept)]
    parts += [_rule("constants of this scene"), constants(plan)]
    parts += [*top_level_blocks("\n".join([*stage_tables(plan), *regressor_tables(plan)]))]
    parts += [_rule("the tick, and the functions of the header")]
    parts += top_level_blocks("\n\n".join(functions(plan, _MANIFEST)))
    parts += [_rule("self-test"), "#ifndef SP_NO_SELFTEST /* to leave it out of an image */"]
    parts += ["\n".join(golden_arrays(plan)), *top_level_blocks(selftest(plan)), "#endif"]
    body = "\n\n".join(without_unused(parts))
    quiet, loud = (_QUIET, _LOUD) if "sp_forest.h" in planned_headers(plan) else ("", "")
    text = filled("single_head.txt", plan, PACKAGE, QUIET=quiet, LOUD=loud, BODY="\n" + body)
    text = _renamed(text, prefix, plan.real)
    manifest = short_manifest_text(plan).replace("\\", "\\\\").replace('"', '\\"')
    return text.replace("@NAME@", plan.scene.name).replace(_MANIFEST, manifest)


def _renamed(text: str, prefix: str, real: str) -> str:
    """The scene's prefix and number type for every name; sp_NAME.h names a section."""
    text = re.sub(r"\bsp_real\b(?!\.h)", real, text)
    return re.sub(r"\bsp_(\w+)\b(?!\.h)", rf"{prefix}_\1", text)


def _rule(title: str) -> str:
    return f"/* {'-' * (_WIDTH - 7 - len(title))} {title} */"


def _library(plan: Plan) -> str:
    """Note on linking, for a scene with square roots; empty without any."""
    if "sp_rbf.h" not in planned_headers(plan):
        return ""
    return (
        " * Link with -lm: a square root may be a call. On a PC, -fno-math-errno halves the\n"
        " * instructions of a tick, for then square roots go side by side; the bits are the same.\n"
    )


@cache
def _unit(header: str) -> tuple[str, ...]:
    """Blocks of a unit's header, without its guard and its includes."""
    text = (SOURCE / header).read_text()
    guard = header.replace(".", "_").upper()
    text = text.replace(f"#ifndef {guard}\n#define {guard}\n", "").rstrip("\n")
    text = _ANALYSIS.sub("", _INCLUDES.sub("", text.removesuffix("#endif")))
    return tuple(top_level_blocks(_ELSEWHERE.sub("", text)))


def _numbers(real: str) -> str:
    """sp_real.h without its type, which the C writes as what it is."""
    text = (INCLUDE / real / "sp_real.h").read_text()
    return "\n\n".join(
        block for block in top_level_blocks(text) if "#define sp_" in block or "_MAX" in block
    )


def _notes() -> str:
    """sp_notes.h with its guard: scenes share it."""
    text = (INCLUDE / "sp_notes.h").read_text()
    return text[text.index("#ifndef") :]


def _state_types(plan: Plan) -> dict[str, None]:
    """Blocks of the units that define what the state is made of, in order."""
    names = {member.declaration.split()[0] for member in state_members(plan)}
    found = [block for header in planned_headers(plan) for block in _unit(header)]
    return {
        block: None
        for block in found
        if (last := re.search(r"\} (\w+);$", code_of(block).rstrip())) and last[1] in names
    }


def _state(plan: Plan) -> str:
    members = "\n".join(f"    {member.declaration};" for member in state_members(plan))
    return filled(
        "single_state.txt",
        plan,
        PACKAGE,
        TYPES="\n\n".join(_state_types(plan)),
        MEMBERS=members,
        BYTES=str(state_bytes(plan)),
        NUMBERS=scene_numbers(plan),
    )
