"""Plan -> the text of every emitted file. No dates, no paths: the same plan, the same bytes."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from typing import Any

import numpy as np

from springpot.codegen.emit.glue import public_header, scene_header, scene_source
from springpot.codegen.emit.golden import (
    backward_velocity,
    golden_places,
    golden_positions,
    probe_inputs,
)
from springpot.codegen.emit.project import filled, selftest_source
from springpot.codegen.literals import wrapped
from springpot.codegen.model.model_file import model_hash
from springpot.codegen.plan.plan import Plan
from springpot.codegen.plan.units import (
    instruction_bound,
    measured_tables,
    planned_headers,
    stages,
    state_bytes,
)
from springpot.codegen.reference.run import run_reference
from springpot.codegen.stages.stage import RegressorStage, Stage
from springpot.runtime_c.paths import FLAGS_FILE, INCLUDE, SOURCE

_HASH = "@manifest-hash@"


def emit_files(plan: Plan, facts: Mapping[str, Any] | None = None) -> dict[str, str]:
    """Return file name -> text of everything that is emitted.

    Generated files begin with the version and the manifest's hash, which covers every file here.
    facts: for the manifest, of `force_facts`, a search of up to a second: a build that no user
    keeps goes without.
    """
    prefix = plan.scene.runtime.prefix
    sources = (f"{prefix}_scene.c", f"{prefix}_selftest.c")
    files = {
        f"{prefix}.h": public_header(plan),
        f"{prefix}_scene.h": scene_header(plan),
        f"{prefix}_tables.h": _header(plan, "tables", stage_tables(plan)),
        sources[0]: scene_source(plan, short_manifest_text(plan)),
        f"{prefix}_golden.h": _golden_header(plan),
        sources[1]: selftest_source(plan),
        "main.c": filled("main.c", plan, HEADER=f"{prefix}_scene.h"),
        "Makefile": filled("Makefile", plan),
    }
    if plan.regressor is not None:
        files[f"{prefix}_regressor.h"] = _header(plan, "regressor", regressor_tables(plan))
    files = {name: stamp(name) + text for name, text in files.items()}
    for header in ["sp_notes.h", *planned_headers(plan)]:
        folder = INCLUDE if header == "sp_notes.h" else SOURCE
        files[header] = (folder / header).read_text()
    files["sp_real.h"] = (INCLUDE / plan.real / "sp_real.h").read_text()
    files["flags.mk"] = FLAGS_FILE.read_text()
    files["manifest.json"] = manifest_text(plan, facts or {}, sources)
    return hashed(files)


def hashed(files: Mapping[str, str]) -> dict[str, str]:
    """The files with the hash of them all in the place of its mark."""
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(f"{name}\n{files[name]}".encode())
    return {name: text.replace(_HASH, digest.hexdigest()) for name, text in files.items()}


def manifest_text(plan: Plan, facts: Mapping[str, Any], sources: Sequence[str]) -> str:
    """manifest.json; sources: names of the C files that are compiled."""
    found = {**_manifest(plan, facts), "sources": list(sources)}
    return json.dumps(found, indent=2, sort_keys=True) + "\n"


def short_manifest_text(plan: Plan) -> str:
    """Short manifest, which the image itself reports, as JSON."""
    return json.dumps(_short_manifest(plan))


def _manifest(plan: Plan, facts: Mapping[str, Any]) -> dict[str, Any]:
    """All metadata of the emission, for people and tools."""
    return {
        **_short_manifest(plan),
        "target": plan.scene.runtime.target,
        "model_hash": model_hash(plan.model),
        "provenance": dict(plan.model.provenance),
        "contact": "surface" if plan.contact else "always",
        "coupling": coupling_metadata(plan),
        "outside": plan.outside,
        "accept_unsafe": plan.accept_unsafe,
        **_model_metadata(plan),
        **_places(plan),
        **facts,
        "state_bytes": state_bytes(plan),
        **({"instructions": asdict(bound)} if (bound := instruction_bound(plan)) else {}),
        "limits": {
            "min_n": float(plan.output.min_n),
            "max_n": float(plan.output.max_n),
            "watchdog_s": plan.watchdog_s,
            "jump_m": float(plan.guard.jump_m),
            "slew_nps": float(plan.output.slew_n) / plan.dt_s,
            "recovery_ticks": plan.recovery_ticks,
        },
        "units": [header.removesuffix(".h") for header in planned_headers(plan)],
        "left_out": [asdict(item) for item in plan.left_out],
    }


def coupling_metadata(plan: Plan) -> dict[str, Any]:
    """Mode, gains, why, and what a hand will feel on the object's stiffest part."""
    choice = plan.coupling
    gains = asdict(choice.coupling) if plan.couple is not None else {"mode": "off"}
    return {
        **gains,
        "why": choice.why,
        "object_stiffness_npm": plan.stiffness_npm,
        "felt_stiffness_npm": choice.felt_npm,
    }


def _model_metadata(plan: Plan) -> dict[str, Any]:
    features, regressor = plan.features, plan.regressor
    return {
        "orders": list(getattr(features, "orders", ())),
        "window_s": plan.model.memory_s,
        **({} if regressor is None else regressor.manifest()),
    }


def _places(plan: Plan) -> dict[str, Any]:
    """Extent of the map, m, of a scene with places."""
    hammerstein = plan.model.hammerstein
    if hammerstein is None or (places := hammerstein.places) is None:
        return {}
    return {
        "places": {
            "x_m": [float(places.first_m[0]), float(places.last_m[0])],
            "y_m": [float(places.first_m[1]), float(places.last_m[1])],
            "nodes": list(places.nodes),
            "materials": len(places.slopes_n),
            "start_m": list(places.stiffest_m),
        }
    }


def _short_manifest(plan: Plan) -> dict[str, Any]:
    """Short manifest, which the image itself reports (sp_manifest)."""
    trained = plan.model.trained
    return {
        "springpot": version("springpot"),
        "hash": _HASH,
        "scene": plan.scene.name,
        "model": plan.model.kind,
        "si_units": "m, m/s, N, s",
        "dt_s": plan.dt_s,
        "number": plan.scene.runtime.number,
        "trained": {
            "depth_m": [trained.min_m, trained.max_m],
            "speed_mps": trained.max_mps,
            "force_n": [trained.min_n, trained.max_n],
        },
    }


def stamp(name: str) -> str:
    """First line of a generated file."""
    text = f"springpot {version('springpot')} {_HASH}"
    return f"# {text}\n" if name == "Makefile" else f"/* {text} */\n"


def stage_tables(plan: Plan) -> list[str]:
    """Constant arrays of every stage; the two of the excess share theirs."""
    once = [stage for stage in stages(plan) if not plan.excess or stage is not plan.excess[1]]
    return [*_spaced(once), *measured_tables(plan)]


def regressor_tables(plan: Plan) -> list[str]:
    """Constant arrays of the regressor; none without one."""
    return [] if plan.regressor is None else _spaced([plan.regressor])


def _spaced(parts: Sequence[Stage | RegressorStage]) -> list[str]:
    return [line for part in parts for line in ("", *part.tables())]


def _header(plan: Plan, name: str, lines: Sequence[str]) -> str:
    prefix = plan.scene.runtime.prefix
    guard = f"{prefix}_{name}_H".upper()
    head = f"#ifndef {guard}\n#define {guard}\n\n#include <stddef.h>\n\n"
    return "\n".join([f'{head}#include "{prefix}_scene.h"', *lines, "\n#endif\n"])


def golden_arrays(plan: Plan) -> list[str]:
    """Inputs and the reference's forces as bit patterns: a NaN has no literal."""
    positions = golden_positions(plan)
    velocities = backward_velocity(positions, plan.dt_s) if plan.needs_device_velocity else None
    columns = {"golden_position": positions}
    if velocities is not None:
        columns["golden_velocity"] = velocities
    run = run_reference(plan, positions, velocities, places=golden_places(plan))
    columns["golden_force"] = run.force_n
    if plan.features is not None and (probe := plan.features.probe()) is not None:
        columns["golden_probe"] = probe.sums(probe_inputs(probe, plan.dtype))
    bits, c_type = (np.uint32, "uint32_t") if plan.real == "float" else (np.uint64, "uint64_t")
    parts = []
    for name, values in columns.items():
        items = [f"0x{pattern:x}u" for pattern in values.view(bits).tolist()]
        parts.append(f"static const {c_type} {name}[{len(items)}] = {{")
        parts += [*wrapped(items), "};"]
    parts.append(f"static const uint8_t golden_notes[{len(run.notes)}] = {{")
    return [*parts, *wrapped(map(str, run.notes.tolist())), "};"]


def _golden_header(plan: Plan) -> str:
    guard = f"{plan.scene.runtime.prefix.upper()}_GOLDEN_H"
    head = f"#ifndef {guard}\n#define {guard}\n\n#include <stdint.h>\n"
    return "\n".join([head, *golden_arrays(plan), "\n#endif\n"])
