"""The report: one self-contained HTML page on an emitted and validated scene."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.atomic_write import write_file
from springpot.codegen.emit.single import SINGLE_EXAMPLE
from springpot.codegen.errors import DataError
from springpot.host.emission.emission import (
    MODEL_COPY,
    SCENE_COPY,
    Emitted,
    read_emission,
    require_emission,
)
from springpot.host.metrics import JND_WORDS, floor_words, start_up_ramp
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary, scene_files
from springpot.host.pages.page import page_text
from springpot.host.session.note_words import notes_in_words
from springpot.host.stability.check import stability
from springpot.host.stability.report import stability_section
from springpot.host.stiffness import slope_words
from springpot.host.validation import figures
from springpot.host.validation.by_place import PlaceError
from springpot.host.validation.error_parts import errors_by_speed
from springpot.host.validation.findings import (
    accuracy_findings,
    by_place_findings,
    code_findings,
    relaxation_finding,
    stability_finding,
)
from springpot.host.validation.place_figure import place_figure
from springpot.host.validation.relaxation import recorded_hold, scene_hold
from springpot.host.validation.store import Stored, read_validation

_REPORT_NAME = "report.html"


def write_report(folder: Path) -> Path:
    """Write folder/report.html: accuracy, relaxation, stability, what was left out.

    Runs a minute's hold and the whole stability check. Raises DataError where the folder was not
    emitted or validated.
    """
    stored, emitted = _validated(folder)
    result = stored.metadata["result"]
    plan, model = emitted.plan, emitted.model
    library = SceneLibrary(folder)
    manifest = json.loads((folder / "manifest.json").read_text())
    replay = Replay(library)
    # Samples of each recording while the force rose from zero: no error counts them.
    ramps = [start_up_ramp(replay.run(item.position_m)[1]) for item in stored.series]
    speeds = errors_by_speed(stored.series, ramps)
    mean_error_n = result["mean_error_n"]
    hold, recorded = scene_hold(plan, replay), recorded_hold(stored.series)
    checked = stability(plan)
    shares = model.provenance.get("importance", [])
    orders = getattr(model.features, "orders", ())
    typical = figures.typical_series(stored.series)
    places = [PlaceError(**each) for each in result.get("places", [])]
    loops, loop_rows = figures.hysteresis_loops(typical)
    context = {
        "title": plan.scene.name,
        "manifest": manifest,
        "result": result,
        "machine": stored.metadata["machine"],
        "recordings": stored.metadata["recordings"],
        "provenance": dict(model.provenance),
        "findings": [
            *accuracy_findings(result, mean_error_n, speeds),
            *by_place_findings(places),
            relaxation_finding(plan, hold, recorded),
            stability_finding(checked),
            *code_findings(result, manifest),
        ],
        "mean_error_n": mean_error_n,
        "notes": notes_in_words(result["notes"]),
        "over_floor": floor_words(result),
        "slopes": slope_words(result),
        "jnd_words": JND_WORDS,
        "speeds": speeds,
        "predictions": figures.prediction_figures(stored.series),
        "by_place": place_figure(places, _extent_m(manifest)),
        "loops": loops,
        "loop_rows": loop_rows,
        "held": figures.held_forces(hold, recorded),
        "percentage_error": figures.percentage_error(stored.series),
        "importance": figures.importance(orders, shares) if orders and shares else "",
        "ticks": figures.tick_histogram(stored.tick_ns, result["tick_ns"]["hot_median"]),
        "commands": _commands(folder, stored, manifest),
        **stability_section(checked),
    }
    path = folder / _REPORT_NAME
    # angle: loss angle of a complex stiffness, degrees.
    text = page_text("report.html", context, angle=lambda it: f"{np.degrees(np.angle(it)):.1f}")
    write_file(path, text.encode())
    return path


def _validated(folder: Path) -> tuple[Stored, Emitted]:
    """Read an emission and its validation. Raises DataError if they do not belong together."""
    require_emission(folder)
    stored = read_validation(folder)
    result = stored.metadata["result"]
    emitted = read_emission(folder, accept_edited=bool(result.get("edited")))
    if emitted.hash != result["hash"] or "slope_floor_percent" not in result:
        raise DataError(
            f"{folder}: changed since it was validated, or validated by an older springpot: "
            "`springpot validate` again"
        )
    return stored, emitted


def _extent_m(manifest: dict[str, Any]) -> tuple[list[float], list[float]] | None:
    """Ends of the scene's map along x and y."""
    places = manifest.get("places")
    return None if places is None else (places["x_m"], places["y_m"])


def by_hand(folder: Path) -> str:
    """The build of an emission without Python."""
    files = scene_files(folder)
    if not files.single:
        return f"make -C {folder.name} test    # {files.prefix}_selftest.c, without Python"
    names = (files.sources[0], SINGLE_EXAMPLE.format(files.prefix))
    sources = " ".join(f"{folder.name}/{name}" for name in names)
    return f"cc -O2 -I{folder.name} {sources} -lm"


def _commands(folder: Path, stored: Stored, manifest: dict[str, Any]) -> list[str]:
    seed = manifest["provenance"]["seed"]
    return [
        f"springpot train TRAINING --model {manifest['model']} --seed {seed} --out model.spm",
        f"springpot emit --scene SCENE.toml --out {folder.name}",
        f"springpot validate {folder.name} --recording VALIDATION",
        f"springpot report {folder.name}",
        by_hand(folder),
        f"# model and scene: {folder.name}/{MODEL_COPY}, {folder.name}/{SCENE_COPY}; "
        f"{len(stored.series)} validation recordings",
    ]
