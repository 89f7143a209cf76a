"""Every kind, and `auto`, on objects that do not share our models' structure.

    python tests/bench/judges.py OUT [--objects a,b] [--structures x,y] [--seed 2] [--write]

Simulated objects by structures of recording (support/presses/structures.py), and Mach-1 with one
frequency left out in turn. Models are fitted on the training part, emitted, built, and replayed on
the test part. OUT keeps what was measured: a run goes on where another ended, and measures again
what other code would make different. All of it is in OUT/judges.json. --write: all cells, and
with them docs/figures.json, docs/bars.svg and README's sentences. A model that fails ends the
command with status 1, and nothing is written.
"""

import argparse
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Memory, Parallel, delayed
from judges_recordings import SEED, SETTINGS, Recordings, recorded
from matplotlib.figure import Figure
from spring_dashpot import spring_dashpot_percent
from support.files.mach1 import mach1_recordings
from support.pages.figures import (
    FILE,
    MACH1,
    PAPER,
    PASSIVE,
    README,
    errors_percent,
    groups,
    written,
)
from support.paths import ROOT

from springpot import Fit, train
from springpot.codegen.make_plan import make_plan
from springpot.codegen.native.compiler import machine_metadata
from springpot.codegen.scene import Target
from springpot.host.bench.bench import code_hash
from springpot.host.bench.measure import bench_scene, hot_ns, measure_sizes, prediction_errors
from springpot.host.native.scene_library import build_and_load
from springpot.host.native.toolchain import missing_tools
from springpot.host.simulation.objects import FOREIGN_OBJECTS, OBJECTS
from springpot.trainer.recordings.quality.repeats import find_noise_floor

MACH1_FILE = Path(__file__).parents[1] / "data" / MACH1 / "Dynamic_data.txt"
TARGET: Target = "cortex-m4f"
KIN_STRUCTURES = ("paper", "left-out-depth")  # of the five that are much alike
KINDS: dict[str, tuple[str, dict[str, Any]]] = {
    PASSIVE: ("hammerstein", {}),
    PAPER: ("rf-fd", {"tree_rows": 1.0, "split_features": 1 / 3}),
    "rf-fd": ("rf-fd", {}),
    "rbf-fd": ("rbf-fd", {}),
    "auto": ("auto", {}),
}
Cell = tuple[str, str]  # an object and a structure; of Mach-1, the recording that is left out


def recordings(cell: Cell, seed: int) -> tuple[Recordings, Recordings, float | None]:
    """Training part, test part, and the noise floor of the latter, N; None if unknown."""
    name, structure = cell
    if name != MACH1:
        return recorded(name, structure, seed)
    found = mach1_recordings(MACH1_FILE)
    test = tuple(each for each in found if each.name.endswith(f"-{structure}"))
    return tuple(each for each in found if each not in test), test, find_noise_floor(test).rms_n


def judged(cell: Cell, seed: int, code: str) -> dict[str, Any]:
    """One cell, by every kind; a failure is a result. code: hash of what measures."""
    training, test, floor_n = recordings(cell, seed)
    peak_n = max(float(np.abs(each.force_n).max()) for each in test)
    models: dict[str, Any] = {}
    for name, (kind, options) in KINDS.items():
        try:
            models[name] = measured(train(training, kind, **options), training, test)
        except Exception as error:
            models[name] = {"failed": f"{type(error).__name__}: {error}"}
    return {
        "object": cell[0],
        "structure": cell[1],
        "floor_percent": None if floor_n is None else 100.0 * floor_n / peak_n,
        "spring_dashpot_percent": spring_dashpot_percent(training, test),
        "rows": sum(len(each.force_n) for each in training),
        "models": models,
    }


def measured(fit: Fit, training: Recordings, test: Recordings) -> dict[str, Any]:
    """One model: built, and replayed on the test part."""
    plan = make_plan(fit.model, bench_scene("float32"), accept_unsafe=True)
    library = build_and_load(plan)
    errors = prediction_errors(plan, library, test, training)
    tick_ns = hot_ns(library, test)
    percent = errors["rmse_percent_of_peak"]
    if not np.isfinite(percent):
        raise ValueError(f"the force is not finite ({percent})")
    chosen = {"chosen": fit.metadata["chosen"]} if "chosen" in fit.metadata else {}
    slopes = {name: value for name, value in errors.items() if name.startswith("slope_")}
    sizes = measure_sizes(fit.model, "float32", TARGET)
    return {"percent": percent, "tick_ns": tick_ns, **slopes, **chosen, **sizes}


def all_cells() -> Iterator[Cell]:
    """The foreign objects first, real data, the five that are hammerstein's kin last."""
    yield from ((name, structure) for name in FOREIGN_OBJECTS for structure in SETTINGS)
    yield from ((MACH1, each.name.rpartition("-")[2]) for each in mach1_recordings(MACH1_FILE))
    yield from ((name, structure) for name in OBJECTS for structure in KIN_STRUCTURES)


def in_a_line(found: dict[str, Any]) -> str:
    """Floor and errors, % of peak."""
    errors = ", ".join(
        f"{name} {model['percent']:.2f}" if "percent" in model else f"{name} failed"
        for name, model in found["models"].items()
    )
    floor = found["floor_percent"]
    known = "unknown" if floor is None else f"{floor:.2f}"
    return f"{found['object']} {found['structure']}: floor {known}, {errors} %"


def draw_bars(cells: list[dict[str, Any]], file: Path) -> None:
    """Draw README's figure: geometric means of the errors, % of peak."""
    figure = Figure(figsize=(9.0, 4.3), layout="constrained")
    panels = groups(cells)
    for axes, (title, shown) in zip(figure.subplots(2), panels.items(), strict=True):
        errors = errors_percent(shown)
        means = list(errors.values())
        drawn = axes.barh(list(errors), means, color=("#8c3b1a", "#c98f6b", "#9a9a9a", "#d9d9d9"))
        axes.bar_label(drawn, [f"{mean:.3g} %" for mean in means], padding=4)
        axes.set_title(f"{title}: {len(shown)} recordings that the model has not seen", fontsize=10)
        axes.invert_yaxis()
        axes.set_xticks([])
        axes.spines[:].set_visible(False)
    figure.savefig(file, metadata={"Date": None})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--objects", help="names, separated by commas; default: all")
    parser.add_argument("--structures", help="names, separated by commas; default: all")
    parser.add_argument("--seed", type=int, default=SEED, help="of noise and random commands")
    parser.add_argument("--write", action="store_true", help="docs/figures.json, README's figures")
    asked = parser.parse_args()
    wanted = [
        cell
        for cell in all_cells()
        if not asked.objects or cell[0] in asked.objects.split(",")
        if not asked.structures or cell[1] in asked.structures.split(",")
    ]
    if asked.write and (missing := missing_tools(TARGET)):
        parser.error(f"--write: {missing}")
    if asked.write and (wanted != list(all_cells()) or asked.seed != SEED):
        parser.error("--write: README's figures are of all cells, with the seed as it is")
    os.environ |= {"OMP_NUM_THREADS": "1", "LOKY_MAX_CPU_COUNT": "1"}  # more wait for each other
    cached = Memory(asked.out / "measured", verbose=0).cache(judged)
    cells: list[dict[str, Any]] = []
    jobs = (delayed(cached)(cell, asked.seed, code_hash()) for cell in wanted)
    for cell in Parallel(n_jobs=2, return_as="generator")(jobs):
        cells.append(cell)
        print(f"{len(cells)} of {len(wanted)}, {in_a_line(cell)}", flush=True)
    metadata = machine_metadata()
    machine = f"{metadata['processor']}, {metadata['system']}"
    figures = {"code": code_hash(), "machine": machine, "compiler": metadata["compiler"],
               "cells": cells}  # fmt: skip
    (asked.out / "judges.json").write_text(json.dumps(figures, indent=1) + "\n")
    print(asked.out / "judges.json")
    failures = [
        f"{cell['object']} {cell['structure']}, {name}: {model['failed']}"
        for cell in cells
        for name, model in cell["models"].items()
        if "failed" in model
    ]
    if failures:
        sys.exit("\n".join(["failed:", *failures]))
    if asked.write:
        FILE.write_text(json.dumps(figures, indent=1) + "\n")
        draw_bars(cells, ROOT / "docs/bars.svg")
        README.write_text(written(README.read_text(encoding="utf-8"), figures), encoding="utf-8")


if __name__ == "__main__":
    main()
