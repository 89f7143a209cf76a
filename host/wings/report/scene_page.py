"""The report: one self-contained HTML page on an emitted and validated scene."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from springpot import DataError, Model
from springpot.basics import write_file
from springpot.checks import stability
from springpot.emission import (
    MODEL_COPY,
    SCENE_COPY,
    Emitted,
    by_hand,
    read_emission,
    require_emission,
)
from springpot.figures import page_text
from springpot.host.wings.report import figures
from springpot.host.wings.report.error_parts import errors_by_speed
from springpot.host.wings.report.findings import (
    accuracy_findings,
    by_place_findings,
    code_findings,
    relaxation_finding,
    stability_finding,
)
from springpot.host.wings.report.place_figure import place_figure
from springpot.host.wings.report.relaxation import recorded_hold, scene_hold
from springpot.host.wings.report.stability_page import stability_section
from springpot.loop import notes_in_words
from springpot.native import Replay, SceneLibrary
from springpot.validation import (
    JND_WORDS,
    PlaceError,
    Stored,
    floor_words,
    read_validation,
    slope_words,
    start_up_ramp,
)

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
    places = [PlaceError(**each) for each in result.get("places", [])]
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
        "notes": notes_in_words(result["notes"], result["clamped_low"], result["min_n"]),
        "over_floor": floor_words(result),
        "slopes": slope_words(result),
        "jnd_words": JND_WORDS,
        "speeds": speeds,
        "by_place": place_figure(places, _extent_m(manifest)),
        "commands": _commands(folder, stored, manifest),
        "held": figures.held_forces(hold, recorded),
        **_drawn(stored, model),
        **stability_section(checked),
    }
    path = folder / _REPORT_NAME
    # angle: loss angle of a complex stiffness, degrees.
    text = page_text(
        "report.html",
        context,
        "springpot.host.wings.report",
        angle=lambda it: f"{np.degrees(np.angle(it)):.1f}",
    )
    write_file(path, text.encode())
    return path


def _drawn(stored: Stored, model: Model) -> dict[str, Any]:
    """Figures of a validation, and of what its model looks at."""
    shares = model.provenance.get("importance", [])
    orders = getattr(model.features, "orders", ())
    loops, loop_rows = figures.hysteresis_loops(figures.typical_series(stored.series))
    hot_ns = stored.metadata["result"]["tick_ns"]["hot_median"]
    return {
        "predictions": figures.prediction_figures(stored.series),
        "loops": loops,
        "loop_rows": loop_rows,
        "percentage_error": figures.percentage_error(stored.series),
        "importance": figures.importance(orders, shares) if orders and shares else "",
        "ticks": figures.tick_histogram(stored.tick_ns, hot_ns),
    }


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
