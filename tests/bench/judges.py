"""Every candidate of `auto`, and `auto` itself, on objects that do not share our models' structure.

    python tests/bench/judges.py OUT [--mach1 Dynamic_data.txt] [--objects a,b] [--structures x,y]

Simulated objects by structures of recording (support/presses/structures.py), and Mach-1 with one
frequency left out in turn. Models are fitted on the training part, emitted, built, and replayed on
the test part. Each cell is one file of OUT/cells, written after every candidate: a run goes on
where another ended, and computes again only what other code or other data would make different.
Two processes; it says how long it still takes. OUT/judges.json holds all cells of OUT.
"""

import argparse
import json
import os
import subprocess
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from judges_recordings import PAPER_SIGNALS, SEED, SETTINGS, Recordings, recorded
from spring_dashpot import spring_dashpot_percent
from support.files.mach1 import mach1_recordings

from springpot.codegen.make_plan import make_plan
from springpot.host.bench.bench import code_hash, key_of
from springpot.host.bench.measure import bench_scene, hot_ns, prediction_errors
from springpot.host.native.compiler import machine_metadata
from springpot.host.native.scene_library import built
from springpot.host.simulation.objects import FOREIGN_OBJECTS, OBJECTS
from springpot.trainer.kinds import AUTO, fit_kind
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.training_set import training_set
from springpot.trainer.recordings.quality.repeats import find_noise_floor
from springpot.trainer.selection.auto import candidates

PROCESSES = 2
MACH1 = "mach1"
KIN_STRUCTURES = ("paper", "left-out-depth")  # of the five that are much alike
BESIDE = ("rf-fd", "rbf-fd")  # the paper's, which auto does not try
_CELL_CPU_S = 50.0  # of a cell, by the last run, most of it auto's


@dataclass(frozen=True)
class Cell:
    """An object in a structure of recording; of Mach-1, the recording that is left out.

    seed: of the sensors' noise, and of random commands.
    """

    name: str
    structure: str
    file: Path | None = None
    seed: int = SEED

    def stored(self, out: Path) -> Path:
        return out / "cells" / f"{self.name}.{self.structure}.json"

    def key(self) -> str:
        """Of all that decides its figures."""
        content = self.file.read_bytes().hex() if self.file else self.settings()
        return key_of([code_hash(), self.name, self.structure, content])

    def settings(self) -> list[object]:
        return [SETTINGS[self.structure], self.seed, PAPER_SIGNALS]

    def recordings(self) -> tuple[Recordings, Recordings, float | None]:
        """Training part, test part, and the noise floor of the latter, N; None if unknown."""
        if self.file is None:
            return recorded(self.name, self.structure, self.seed)
        found = mach1_recordings(self.file)
        test = tuple(each for each in found if each.name.endswith(f"-{self.structure}"))
        floor_n = find_noise_floor(test).rms_n
        return tuple(each for each in found if each not in test), test, floor_n


def judged(cell: Cell, out: Path) -> dict[str, Any]:
    """Do what is missing of a cell."""
    stored = known(cell, out)
    if stored.get("complete"):
        return stored
    training, test, floor_n = cell.recordings()
    data, options = training_set(training, FitOptions().smooth_s), FitOptions()
    peak_n = max(float(np.abs(each.force_n).max()) for each in test)
    listed = {each.name: (each.kind, each.options) for each in candidates(data, options)}
    listed |= {kind: (kind, options) for kind in BESIDE}
    found = stored | {
        "key": cell.key(),
        "object": cell.name,
        "structure": cell.structure,
        "floor_percent": None if floor_n is None else 100.0 * floor_n / peak_n,
        "spring_dashpot_percent": spring_dashpot_percent(training, test),
        "rows": data.rows_total,
    }
    models = found.setdefault("models", {})
    for name, (kind, asked) in {**listed, AUTO: (AUTO, options)}.items():
        if name not in models:
            begin_s = time.process_time()
            try:
                models[name] = measured(kind, data, asked, test)
            except Exception as error:  # a failure is a result
                models[name] = {"failed": f"{type(error).__name__}: {error}"}
            models[name]["cpu_s"] = time.process_time() - begin_s
            write(cell, out, found)
    found["complete"] = True
    write(cell, out, found)
    return found


def measured(kind: str, data: Any, options: FitOptions, test: Recordings) -> dict[str, Any]:
    """One model: fitted, built, and replayed on the test part."""
    fit = fit_kind(kind, "judged", data, options)
    plan = make_plan(fit.model, bench_scene("float32"), accept_unsafe=True)
    library = built(plan)
    errors = prediction_errors(plan, library, test, data.recordings)
    tick_ns = hot_ns(library, test)
    percent = errors["rmse_percent_of_peak"]
    if not np.isfinite(percent):
        raise ValueError(f"the force is not finite ({percent})")
    chosen = {"chosen": fit.metadata["chosen"]} if "chosen" in fit.metadata else {}
    slopes = {name: value for name, value in errors.items() if name.startswith("slope_")}
    return {"percent": percent, "tick_ns": tick_ns, **slopes, **chosen}


def known(cell: Cell, out: Path) -> dict[str, Any]:
    """What is stored of a cell; nothing where other code or data made it."""
    try:
        found: dict[str, Any] = json.loads(cell.stored(out).read_text())
    except (OSError, ValueError):
        return {}
    return found if found["key"] == cell.key() else {}


def write(cell: Cell, out: Path, found: dict[str, Any]) -> None:
    part = cell.stored(out).with_suffix(".part")
    part.write_text(json.dumps(found, indent=1) + "\n")
    part.replace(cell.stored(out))


def all_cells(mach1: Path | None, seed: int = SEED) -> Iterator[Cell]:
    """The foreign objects first, real data, the five that are hammerstein's kin last."""
    for name in FOREIGN_OBJECTS:
        yield from (Cell(name, structure, seed=seed) for structure in SETTINGS)
    if mach1:
        for each in mach1_recordings(mach1):
            yield Cell(MACH1, each.name.rpartition("-")[2], mach1)
    for name in OBJECTS:
        yield from (Cell(name, structure, seed=seed) for structure in KIN_STRUCTURES)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--mach1", type=Path, help="the tester's text file of sines")
    parser.add_argument("--objects", help="names, separated by commas; default: all")
    parser.add_argument("--structures", help="names, separated by commas; default: all")
    parser.add_argument("--seed", type=int, default=SEED, help="of noise and random commands")
    asked = parser.parse_args()
    (asked.out / "cells").mkdir(parents=True, exist_ok=True)
    wanted = [
        cell
        for cell in all_cells(asked.mach1, asked.seed)
        if not asked.objects or cell.name in asked.objects.split(",")
        if not asked.structures or cell.structure in asked.structures.split(",")
    ]
    # One thread each: more wait for each other.
    os.environ |= {"OMP_NUM_THREADS": "1", "LOKY_MAX_CPU_COUNT": "1"}
    missing = [cell for cell in wanted if not known(cell, asked.out).get("complete")]
    cpu_min = _CELL_CPU_S * len(missing) / PROCESSES / 60
    print(f"{len(wanted)} cells, {len(missing)} of them to compute: about {cpu_min:.0f} min on "
          f"{PROCESSES} idle cores", flush=True)  # fmt: skip
    begin = time.perf_counter()
    with ProcessPoolExecutor(PROCESSES, mp_context=get_context("spawn")) as pool:
        running = {pool.submit(judged, cell, asked.out): cell for cell in missing}
        for done, future in enumerate(as_completed(running), start=1):
            cell, found = running[future], future.result()
            left_s = (time.perf_counter() - begin) / done * (len(missing) - done)
            print(f"{done} of {len(missing)}, {left_s / 60:.0f} min left: {cell.name} "
                  f"{cell.structure}: {in_a_line(found)}", flush=True)  # fmt: skip
    cells = [
        found for cell in all_cells(asked.mach1, asked.seed) if (found := known(cell, asked.out))
    ]
    metadata = machine_metadata()
    result = {
        "commit": commit(),
        "machine": f"{metadata['processor']}, {metadata['system']}",
        "compiler": metadata["compiler"],
        "candidates": list(dict.fromkeys(name for found in cells for name in found["models"])),
        "cells": [{key: value for key, value in found.items() if key != "key"} for found in cells],
    }
    (asked.out / "judges.json").write_text(json.dumps(result, indent=1) + "\n")
    print(f"{asked.out / 'judges.json'}: {len(cells)} cells")


def commit() -> str:
    """What was measured; with "+" where files have changed since."""
    git = ("git", "-C", str(Path(__file__).parent))
    head, changed = (
        subprocess.run([*git, *words], capture_output=True, text=True, check=True).stdout.strip()
        for words in (("rev-parse", "HEAD"), ("status", "--porcelain", "--untracked-files=no"))
    )
    return head + "+" * bool(changed)


def in_a_line(found: dict[str, Any]) -> str:
    """Floor and errors, % of peak."""
    errors = ", ".join(
        f"{name} {model['percent']:.2f}" if "percent" in model else f"{name} failed"
        for name, model in found["models"].items()
    )
    floor = found["floor_percent"]
    return f"floor {'unknown' if floor is None else f'{floor:.2f}'}, {errors} %"


if __name__ == "__main__":
    main()
