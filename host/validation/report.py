"""The report: one self-contained HTML page on an emitted and validated scene."""

import json
from pathlib import Path
from typing import Any

from springpot.codegen.atomic_write import write_file
from springpot.codegen.errors import DataError
from springpot.host.emission.emission import MODEL_COPY, SCENE_COPY, read_emission, require_emission
from springpot.host.native.scene_library import scene_prefix
from springpot.host.page import page_text
from springpot.host.validation import figures
from springpot.host.validation.store import Stored, read_validation

_REPORT_NAME = "report.html"


def write_report(folder: Path) -> Path:
    """Write folder/report.html. Raises DataError where the folder was not emitted or validated."""
    require_emission(folder)
    stored = read_validation(folder)
    validated = stored.metadata["result"]
    emitted = read_emission(folder, accept_edited=bool(validated.get("edited")))
    if emitted.hash != validated["hash"]:
        raise DataError(f"{folder}: changed since it was validated: `springpot validate` again")
    plan, model = emitted.plan, emitted.model
    manifest = json.loads((folder / "manifest.json").read_text())
    shares = model.provenance.get("importance", [])
    orders = getattr(model.features, "orders", ())
    typical = figures.typical_series(stored.series)
    context = {
        "title": plan.scene.name,
        "manifest": manifest,
        "result": validated,
        "machine": stored.metadata["machine"],
        "recordings": stored.metadata["recordings"],
        "provenance": dict(model.provenance),
        "prediction": figures.prediction_figure(typical),
        "hysteresis": figures.hysteresis(typical),
        "percentage_error": figures.percentage_error(stored.series),
        "importance": figures.importance(orders, shares) if orders and shares else "",
        "ticks": figures.tick_histogram(
            stored.tick_ns, stored.metadata["result"]["tick_ns"]["hot_median"]
        ),
        "commands": _commands(folder, stored, manifest),
    }
    path = folder / _REPORT_NAME
    write_file(path, page_text("report.html", context).encode())
    return path


def _commands(folder: Path, stored: Stored, manifest: dict[str, Any]) -> list[str]:
    seed = manifest["provenance"]["seed"]
    return [
        f"springpot train TRAINING --model {manifest['model']} --seed {seed} --out model.spm",
        f"springpot emit --scene SCENE.toml --out {folder.name}",
        f"springpot validate {folder.name} --recording VALIDATION",
        f"springpot report {folder.name}",
        f"make -C {folder.name} test    # {scene_prefix(folder)}_selftest.c, without Python",
        f"# model and scene: {folder.name}/{MODEL_COPY}, {folder.name}/{SCENE_COPY}; "
        f"{len(stored.series)} validation recordings",
    ]
