"""The benchmark: sweep, front, picks; everything that is known already is read, not repeated."""

import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields, replace
from importlib.metadata import version
from pathlib import Path

from rich.progress import track

from springpot import DataError, Recording, check_recordings
from springpot.basics import Number, Target
from springpot.console import progress_console
from springpot.host.wings.evidence.benchmark.isolated import (
    measure_isolated,
    measure_on_target,
    missing_for,
    unmeasured_on,
)
from springpot.host.wings.evidence.benchmark.measure import (
    BenchRecordings,
    Job,
    measure_point,
    measure_sizes,
    target_compiler,
)
from springpot.host.wings.evidence.benchmark.picks import PlatformBudget, budgets, pareto, pick, why
from springpot.host.wings.evidence.benchmark.point import Isolated, Metadata, Point, Refused
from springpot.host.wings.evidence.benchmark.store import (
    Store,
    code_hash,
    data_key,
    key_of,
    measured_by,
    point_key,
)
from springpot.modelling import KINDS, find_noise_floor
from springpot.native import cpu_s, machine_metadata
from springpot.validation import floor_keys, known_among


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
    from springpot import FitOptions

    plain = FitOptions()
    store = Store(folder)
    store.prepare()
    begin, load = time.perf_counter(), os.getloadavg()[0]
    measures = measured_by(code_hash(), bench.target)
    swept, refused, computed = _sweep(bench, store, measures)
    if not swept:
        raise DataError(f"no model can be made of these recordings: {refused[0].error}")
    swept, computed_sizes = _with_sizes(swept, bench.target, store)
    front = pareto(swept)
    recorded_hz = bench.training[0].rate_hz
    isolated = _Isolated(bench, store, [replace(p, pareto=p.key in front) for p in swept])
    with progress_console.status("isolated timing of the front and the picks") as status:
        for i, point in enumerate(point for point in isolated.points if point.pareto):
            status.update(f"isolated timing: {i + 1} of {len(front)} on the front")
            isolated.complete(point)
        picks = [_picked(budget, recorded_hz, isolated) for budget in budgets(bench.target)]
    metadata = machine_metadata()
    result = {
        "points": [point.as_dict() for point in isolated.points],
        "refused": [point.swept() for point in refused],
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
        "seen": known_among({rec.content_hash for rec in bench.training}, bench.validation),
        "quality": check_recordings(bench.training).as_dict(),
        "validation_floor": floor_keys(find_noise_floor(bench.validation)),
        "closed_loop": isolated.matrices,
        "computed": computed,
        "computed_sizes": computed_sizes,
        "computed_isolated": isolated.computed,
        "wall_s": time.perf_counter() - begin,
        "cpu_s": sum(p.point_cpu_s for p in swept) + isolated.cpu_s,
        "load": load,
    }
    store.write_result(result)
    return result


def _sweep(
    bench: Bench, store: Store, measures: Metadata
) -> tuple[list[Point], list[Refused], int]:
    """Measure every candidate; return points, refused ones, and how many were computed now."""
    from springpot import FitOptions
    from springpot.host.wings.evidence.parallel import in_parallel
    from springpot.host.wings.evidence.sweep import default_sweep

    dt_s = bench.training[0].dt_s
    candidates = default_sweep(dt_s, FitOptions(seed=bench.seed), bench.kinds)
    data = BenchRecordings(
        data_key(bench.training, bench.validation), bench.training, bench.validation
    )
    keyed = {point_key(data.key, measures, candidate): candidate for candidate in candidates}
    known = {key: store.read_point(key) for key in keyed}
    missing = [key for key, point in known.items() if point is None]
    jobs = [Job(key, KINDS[keyed[key].kind], keyed[key], data, bench.target) for key in missing]
    terminal, count = sys.stderr.isatty(), len(keyed) - len(jobs)
    begin = time.perf_counter()
    if jobs:
        progress_console.print(
            f"{len(jobs)} models to measure, seconds each; what is measured is kept, and a bench "
            "that was interrupted goes on from there"
        )
    for measured in track(
        in_parallel(measure_point, jobs, bench.dask), "models", total=len(keyed),
        completed=count, console=progress_console, disable=not terminal,
    ):  # fmt: skip
        store.keep(measured)
        known[measured.point.key] = measured.point
        count += 1
        if not terminal and 8 * count // len(keyed) > 8 * (count - 1) // len(keyed):
            left = len(keyed) - count
            left_min = (time.perf_counter() - begin) / (len(jobs) - left) * left / 60.0
            about = f", about {left_min:.0f} min more" if left else ""
            progress_console.print(f"{count} of {len(keyed)} models measured{about}")
    points = [point for point in known.values() if isinstance(point, Point)]
    refused = [point for point in known.values() if isinstance(point, Refused)]
    return points, refused, len(jobs)


def _with_sizes(points: Sequence[Point], target: Target, store: Store) -> tuple[list[Point], int]:
    """Measure sizes again if the compiler was missing or has another version; return how many.

    What an uninstalled compiler has measured stays.
    """
    from springpot.host.wings.evidence.parallel import in_parallel

    compiler = target_compiler(target)
    found = {point.key: point for point in points}
    stale = [p for p in points if compiler is not None and p.sizes_compiler != compiler]
    jobs = [(point, store.model_file(point.key), target) for point in stale]
    for point in in_parallel(measure_sizes, jobs, None) if jobs else ():
        found[point.key] = point
        store.write_point(point)
    return list(found.values()), len(jobs)


class _Isolated:
    """The points, and what completes them: what is measured alone; known ones are read."""

    def __init__(self, bench: Bench, store: Store, points: Sequence[Point]) -> None:
        self._bench, self._store = bench, store
        self._longest = max(bench.validation, key=lambda item: len(item.position_m))
        self._points = {point.key: point for point in points}
        self.matrices: dict[str, list[Metadata]] = {}
        self.computed = 0
        self.cpu_s = 0.0

    @property
    def points(self) -> list[Point]:
        """All of them, as complete as they are now."""
        return list(self._points.values())

    def complete(self, point: Point) -> Point:
        """Return the point with what is measured isolated."""
        key = point.key
        if key not in self.matrices:
            asked = (self._store.model_file(key), point.number, self._longest)
            metadata = self._once("isolated", key, lambda: measure_isolated(*asked))
            metadata |= self._on_target(key, asked)
            self.matrices[key] = metadata["closed_loop"]
            names = {field.name for field in fields(Isolated)}
            known = {name: value for name, value in metadata.items() if name in names}
            self._points[key] = replace(point, **known)
        return self._points[key]

    def _on_target(self, key: str, asked: tuple[Path, Number, Recording]) -> Metadata:
        target = self._bench.target
        if why := missing_for(target):
            return unmeasured_on(why)  # not kept: the tools may come
        version = key_of([key, target_compiler(target)])
        return self._once("instructions", version, lambda: measure_on_target(*asked, target))

    def _once(self, kind: str, key: str, measure: Callable[[], Metadata]) -> Metadata:
        metadata = self._store.read(kind, key)
        if metadata is None:
            begin_s = cpu_s()
            metadata = measure()
            metadata["spent_cpu_s"] = cpu_s() - begin_s
            self._store.write(kind, key, metadata)
            self.computed += 1
        self.cpu_s += metadata["spent_cpu_s"]
        return metadata


def _picked(budget: PlatformBudget, recorded_hz: float, isolated: _Isolated) -> Metadata:
    chosen = pick(isolated.points, budget, recorded_hz, isolated.complete)
    return {
        "budget": asdict(budget),
        "point": chosen and chosen.key,
        "why": why(chosen, isolated.points, budget, recorded_hz)
        if chosen
        else "no model fits this budget, is passive and stays bounded",
    }


def _named(recording: Recording) -> Metadata:
    return {
        "name": recording.name,
        "hash": recording.content_hash,
        "source": recording.source,
        "duration_s": recording.duration_s,
    }
