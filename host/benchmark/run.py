"""The benchmark: sweep, front, picks; everything that is known already is read, not repeated."""

import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from springpot.codegen.errors import DataError
from springpot.codegen.scene import Number, Target
from springpot.host.benchmark.instructions import count_instructions, uncounted
from springpot.host.benchmark.isolated import measure_isolated
from springpot.host.benchmark.picks import Budget, budgets, pareto, pick, why
from springpot.host.benchmark.point import (
    Data,
    Job,
    SizeJob,
    measure_point,
    measure_sizes,
    target_compiler,
)
from springpot.host.benchmark.store import Store, data_key, key_of, measured_by, point_key
from springpot.host.benchmark.work_precision import work_precision
from springpot.host.console.output import progress_console
from springpot.host.native.machine import cpu_s, machine_metadata
from springpot.trainer.kinds import KINDS
from springpot.trainer.recordings.quality.report import check_recordings
from springpot.trainer.recordings.recording import Recording

Metadata = dict[str, Any]
# Null for points that are off the front and no pick.
_ISOLATED = ("tick_ns_p50", "tick_ns_p99", "tick_ns_p999", "tick_ns_max", "bounded",
          "instructions", "instructions_why", "spectral_radius", "coupling",
          "worst_fidelity_percent", "verdict")  # fmt: skip


@dataclass(frozen=True, eq=False)
class Bench:
    """What to run: recordings, target, seed, the kinds (all where empty), a Dask scheduler."""

    training: tuple[Recording, ...]
    validation: tuple[Recording, ...]
    target: Target
    seed: int = 0
    kinds: tuple[str, ...] = ()
    dask: str | None = None


def run_bench(bench: Bench, folder: Path, command: str) -> Metadata:
    """Run what is missing, write folder/bench.json, and return it."""
    from springpot.trainer.models.fit import FitOptions

    plain = FitOptions()
    store = Store(folder)
    store.prepare()
    begin, load = time.perf_counter(), os.getloadavg()[0]
    measures = measured_by(bench.target)
    found, computed, computed_sizes = _sweep(bench, store, measures)
    points = [metadata for metadata in found if "error" not in metadata]
    if not points:
        raise DataError(f"no model can be made of these recordings: {found[0]['error']}")
    front = pareto(points)
    recorded_hz = bench.training[0].rate_hz
    isolated = _Isolated(bench, store)
    for point in points:
        point["pareto"] = point["key"] in front
        point.update(dict.fromkeys(_ISOLATED))
    with progress_console.status("isolated timing of the front and the picks") as status:
        for i, point in enumerate(point for point in points if point["pareto"]):
            status.update(f"isolated timing: {i + 1} of {len(front)} on the front")
            isolated.complete(point)
        picks = [_picked(points, budget, recorded_hz, isolated) for budget in budgets(bench.target)]
        status.update("work-precision curves")
        curves_key = f"work-precision-{key_of(measures)}"
        curves = store.read("isolated", curves_key) or work_precision()
        store.write("isolated", curves_key, curves)
    metadata = machine_metadata()
    result = {
        "points": points,
        "refused": [point for point in found if "error" in point],
        "picks": {item["budget"]["name"]: item for item in picks},
        "machine": f"{metadata['processor']}, {metadata['system']}",
        "compiler": metadata["compiler"],
        "flags": metadata["flags"],
        "versions": {"scikit-learn": version("scikit-learn"), **metadata},
        "target": bench.target,
        "rate_hz": recorded_hz,
        "seed": bench.seed,
        "defaults": {
            name: getattr(plain, name) for name in ("trees", "leaf", "n_centers", "poles")
        },
        "command": command,
        "recordings": {
            "training": [_named(recording) for recording in bench.training],
            "validation": [_named(recording) for recording in bench.validation],
        },
        "quality": check_recordings(bench.training).as_dict(),
        "work_precision": curves,
        "closed_loop": isolated.matrices,
        "computed": computed,
        "computed_sizes": computed_sizes,
        "computed_isolated": isolated.computed,
        "wall_s": time.perf_counter() - begin,
        "cpu_s": sum(p["point_cpu_s"] for p in points) + isolated.cpu_s,
        "load": load,
    }
    store.write_result(result)
    return result


def _sweep(bench: Bench, store: Store, measures: Metadata) -> tuple[list[Metadata], int, int]:
    """Metadata of every candidate, in the sweep's order; how many were computed now, how many only
    got their sizes."""
    from springpot.trainer.models.fit import FitOptions
    from springpot.trainer.parallel import in_parallel
    from springpot.trainer.selection.sweep import default_sweep

    dt_s = bench.training[0].dt_s
    candidates = default_sweep(dt_s, FitOptions(seed=bench.seed), bench.kinds)
    data = Data(data_key(bench.training, bench.validation), bench.training, bench.validation)
    keyed = {point_key(data.key, measures, candidate): candidate for candidate in candidates}
    known = {key: store.read("points", key) for key in keyed}
    missing = [key for key, metadata in known.items() if metadata is None]
    jobs = [Job(key, KINDS[keyed[key].kind], keyed[key], data, bench.target) for key in missing]
    with _progress() as progress:
        task = progress.add_task("models", total=len(keyed), completed=len(keyed) - len(jobs))
        for point in in_parallel(measure_point, jobs, bench.dask):
            store.keep(point)
            known[point.key] = point.metadata
            progress.advance(task)
    found = [metadata for metadata in known.values() if metadata is not None]
    return found, len(jobs), _complete_sizes(found, bench.target, store)


def _complete_sizes(found: Sequence[Metadata], target: Target, store: Store) -> int:
    """Measure again the sizes of kept points that are of no compiler, or of another version.

    Returns how many. What an uninstalled compiler has measured stays.
    """
    from springpot.trainer.parallel import in_parallel

    compiler = target_compiler(target)
    points = {p["key"]: p for p in found if "error" not in p and p["sizes_compiler"] != compiler}
    if compiler is None or not points:
        return 0
    jobs = [SizeJob(key, store.model_file(key), p["number"], target) for key, p in points.items()]
    for key, sizes in in_parallel(measure_sizes, jobs, None):
        points[key].update(sizes)
        store.write("points", key, points[key])
    return len(jobs)


def _progress() -> Progress:
    return Progress(
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
        TimeElapsedColumn(), TextColumn("rest"), TimeRemainingColumn(elapsed_when_finished=False),
        console=progress_console, disable=not sys.stderr.isatty(),
    )  # fmt: skip


class _Isolated:
    """Completes points with isolated timings; known ones are read."""

    def __init__(self, bench: Bench, store: Store) -> None:
        self._bench, self._store = bench, store
        self._longest = max(bench.validation, key=lambda item: len(item.position_m))
        self.matrices: dict[str, list[Metadata]] = {}
        self.computed = 0
        self.cpu_s = 0.0

    def complete(self, point: Metadata) -> Metadata:
        key = point["key"]
        if key not in self.matrices:
            asked = (self._store.model_file(key), point["number"], self._longest)
            metadata = self._once("isolated", key, lambda: measure_isolated(*asked))
            metadata |= self._instructions(key, asked)
            self.matrices[key] = metadata["closed_loop"]
            point.update({name: metadata.get(name) for name in _ISOLATED})
        return point

    def _instructions(self, key: str, asked: tuple[Path, Number, Recording]) -> Metadata:
        target = self._bench.target
        if why := uncounted(target):  # not kept: the tools may come
            return {"instructions": None, "instructions_why": why}
        version = key_of([key, target_compiler(target)])
        return self._once("instructions", version, lambda: count_instructions(*asked, target))

    def _once(self, kind: str, key: str, measure: Callable[[], Metadata]) -> Metadata:
        """What is kept, or else measured now and kept."""
        metadata = self._store.read(kind, key)
        if metadata is None:
            begin_s = cpu_s()
            metadata = measure()
            metadata["spent_cpu_s"] = cpu_s() - begin_s
            self._store.write(kind, key, metadata)
            self.computed += 1
        self.cpu_s += metadata["spent_cpu_s"]
        return metadata

    def is_bounded(self, point: Metadata) -> bool:
        return bool(self.complete(point)["bounded"])


def _picked(
    points: Sequence[Metadata], budget: Budget, recorded_hz: float, isolated: _Isolated
) -> Metadata:
    chosen = pick(points, budget, recorded_hz, isolated.is_bounded)
    return {
        "budget": budget.as_dict(),
        "point": chosen and chosen["key"],
        "why": why(chosen, points, budget, recorded_hz)
        if chosen
        else "no model fits this budget, gives no energy back and stays bounded",
    }


def _named(recording: Recording) -> Metadata:
    return {
        "name": recording.name,
        "hash": recording.content_hash,
        "source": recording.source,
        "duration_s": recording.duration_s,
    }
