"""Plan -> the text of every emitted file. No dates, no paths: the same plan, the same bytes."""

import hashlib
import json
from dataclasses import asdict
from importlib.metadata import version

from springpot.codegen.emit.c_text import render_template
from springpot.codegen.emit.header import render_header
from springpot.codegen.emit.source import render_source
from springpot.codegen.model.model_file import model_hash
from springpot.codegen.plan import Plan, list_headers, state_bytes
from springpot.codegen.types import JsonObject
from springpot.runtime_c.paths import flags

_HASH = "@manifest-hash@"


def emit_files(plan: Plan, selftest: bool = True) -> dict[str, str]:
    """Return file name -> text: NAME.c, NAME.h, an example main.c, its Makefile, the manifest.

    Generated files begin with the version and the manifest's hash, which covers every file here.
    selftest: False leaves its C out: the forces of its vectors are most of the work for a forest
    behind a proxy.
    """
    prefix = plan.scene.runtime.prefix
    files = {
        f"{prefix}.h": render_header(plan),
        f"{prefix}.c": render_source(plan, json.dumps(_short_manifest(plan)), selftest),
        "main.c": render_template("main.c.j2", plan=plan, prefix=prefix),
        "Makefile": render_template(
            "Makefile.j2", prefix=prefix, flags=" ".join(flags("SP_CFLAGS"))
        ),
    }
    files = {name: version_line(name) + text for name, text in files.items()}
    files["manifest.json"] = json.dumps(_manifest(plan), indent=2, sort_keys=True) + "\n"
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(f"{name}\n{files[name]}".encode())
    return {name: text.replace(_HASH, digest.hexdigest()) for name, text in files.items()}


def _manifest(plan: Plan) -> JsonObject:
    """Return the manifest: what was emitted from which model and scene, and with which limits."""
    return {
        **_short_manifest(plan),
        "sources": [f"{plan.scene.runtime.prefix}.c"],
        "target": plan.scene.runtime.target,
        "model_hash": model_hash(plan.model),
        "provenance": dict(plan.model.provenance),
        "contact": "surface" if plan.contact else "always",
        "coupling": describe_coupling(plan),
        "outside": plan.outside,
        "accept_unsafe": plan.accept_unsafe,
        "orders": list(getattr(plan.features, "orders", ())),
        "window_s": plan.model.memory_s,
        **({} if plan.regressor is None else plan.regressor.manifest()),
        **_map_extent(plan),
        "state_bytes": state_bytes(plan),
        "limits": {
            "min_n": float(plan.output.min_n),
            "max_n": float(plan.output.max_n),
            "watchdog_s": plan.watchdog_s,
            "max_step_m": float(plan.guard.max_step_m),
            "slew_nps": float(plan.output.slew_n) / plan.dt_s,
            "recovery_ticks": plan.recovery_ticks,
        },
        "units": [header.removesuffix(".h") for header in list_headers(plan)],
        "left_out": [asdict(item) for item in plan.left_out],
    }


def describe_coupling(plan: Plan) -> JsonObject:
    """Mode, gains, why, and what a hand will feel on the object's stiffest part."""
    choice = plan.coupling
    gains = asdict(choice.coupling) if plan.couple is not None else {"mode": "off"}
    return {
        **gains,
        "why": choice.why,
        "object_stiffness_npm": plan.stiffness_npm,
        "felt_stiffness_npm": choice.felt_npm,
    }


def _map_extent(plan: Plan) -> JsonObject:
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


def _short_manifest(plan: Plan) -> JsonObject:
    """Return the manifest that the compiled image holds and reports: hashes and limits alone."""
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


def version_line(name: str) -> str:
    """First line of a generated file."""
    text = f"springpot {version('springpot')} {_HASH}"
    return f"# {text}\n" if name == "Makefile" else f"/* {text} */\n"
