"""The benchmark: every candidate measured on all cores or on a cluster, the front, the result."""

import hashlib
import json
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib import resources
from importlib.metadata import version
from operator import itemgetter
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from joblib import Memory, Parallel, delayed, parallel_config
from joblib.memory import MemorizedFunc
from rich.progress import track

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import write_file
from springpot.codegen.native.compiler import machine_metadata
from springpot.codegen.scene import Target
from springpot.codegen.types import JsonObject
from springpot.host.bench.front import ALONE, measure_alone, pareto_front
from springpot.host.bench.measure import (
    BenchRecordings,
    Candidate,
    default_sweep,
    measure_point,
    target_compiler,
)
from springpot.host.output import RESULT, progress_console
from springpot.host.validation.seen import known_among
from springpot.trainer.kinds import KINDS
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording import Recording

_CONNECT_S = 10
_Result = TypeVar("_Result")
_HOLDOUT = 5  # one recording in so many is held out


@dataclass(frozen=True, eq=False)
class Bench:
    """Settings of a benchmark. models: kinds and model files, all by default. dask: a scheduler."""

    training: tuple[Recording, ...]
    validation: tuple[Recording, ...]
    target: Target
    seed: int = 0
    models: tuple[str, ...] = ()
    dask: str | None = None


def run_bench(bench: Bench, folder: Path, command: str) -> JsonObject:
    """Measure what is not measured yet, write folder/bench.json, and return it.

    Raises UsageError for an unknown model, DataError if no model can be made of the recordings.
    """
    begin = time.perf_counter()
    memory = Memory(folder / "measured", verbose=0)
    key = cache_key(
        [code_hash(), machine_metadata(), target_compiler(bench.target)],
        [[item.name, item.content_hash] for item in bench.training],
        [[item.name, item.content_hash] for item in bench.validation],
    )
    data = BenchRecordings(key, bench.training, bench.validation)
    measured = memory.cache(measure_point, ignore=["data"])
    jobs = [(candidate, bench.target, key, data) for candidate in _candidates(bench)]
    measured_points = list(_in_parallel(measured, jobs, bench.dask))
    (folder / "models").mkdir(parents=True, exist_ok=True)
    points = []
    for row, model in measured_points:
        if model is not None:
            name = f"models/{str(row['hash'])[:16]}.spm"
            write_file(folder / name, model)
            points.append(row | {"file": name})
    refused = [row for row, model in measured_points if model is None]
    if not points:
        raise DataError(f"no model can be made of these recordings: {refused[0]['error']}")
    alone = memory.cache(
        measure_alone, ignore=["model_file", "recording", "validation", "training"]
    )
    longest = max(bench.validation, key=lambda item: len(item.position_m))
    front = pareto_front(points)
    timed = [on or point["fit_s"] is None for on, point in zip(front, points, strict=True)]  # files
    for number, (point, on_front) in enumerate(zip(points, front, strict=True)):
        point.update(dict.fromkeys(ALONE), pareto=on_front)
        if timed[number]:
            progress_console.print(f"timing alone: {sum(timed[: number + 1])} of {sum(timed)}")
            point_key = cache_key(key, point["hash"])
            file = folder / str(point["file"])
            point.update(
                alone(
                    file,
                    point["number"],
                    bench.target,
                    point_key,
                    longest,
                    bench.validation,
                    bench.training,
                )
            )
    metadata = machine_metadata()
    result = {
        "points": sorted(points, key=itemgetter("rmse_n")),
        "refused": refused,
        "machine": f"{metadata['processor']}, {metadata['system']}",
        "compiler": metadata["compiler"],
        "flags": metadata["flags"],
        "versions": {"scikit-learn": version("scikit-learn"), **metadata},
        "target": bench.target,
        "rate_hz": bench.training[0].rate_hz,
        "seed": bench.seed,
        "command": command,
        "recordings": {"training": _named(bench.training), "validation": _named(bench.validation)},
        "seen": known_among({item.content_hash for item in bench.training}, bench.validation),
        "wall_s": time.perf_counter() - begin,
    }
    write_file(folder / RESULT, json.dumps(result, indent=1, allow_nan=False).encode())
    return result


def _candidates(bench: Bench) -> list[Candidate]:
    """Raises UsageError for what is neither a kind nor a file."""
    options = FitOptions(seed=bench.seed)
    kinds = [name for name in bench.models if name in KINDS]
    files = [Path(name) for name in bench.models if name not in KINDS]
    for file in files:
        if not file.is_file():
            raise UsageError(f"--model {file}: neither a file nor one of {', '.join(KINDS)}")
    swept = default_sweep(bench.training[0].dt_s, options, kinds) if kinds or not files else []
    return [*swept, *(Candidate("file", options, file=file) for file in files)]


def _named(recordings: Sequence[Recording]) -> list[dict[str, str]]:
    return [{"name": item.name, "hash": item.content_hash, "source": item.source}
            for item in recordings]  # fmt: skip


def _in_parallel(
    work: MemorizedFunc, items: Sequence[tuple[object, ...]], dask: str | None
) -> Iterator[Any]:
    """Yield results in order, with progress. dask: address of a scheduler.

    Raises UsageError if no scheduler answers there.
    """
    if all(work.check_call_in_cache(*item) for item in items):
        yield from (work(*item) for item in items)
        return
    quiet = not progress_console.is_terminal
    with _backend(dask):
        with _without_interrupts():  # workers start here, and inherit it
            results = Parallel(n_jobs=-1, return_as="generator", batch_size=1)(
                delayed(_in_one_thread)(work, item) for item in items
            )
        yield from track(results, "models", len(items), console=progress_console, disable=quiet)


def _in_one_thread(work: Callable[..., _Result], item: tuple[object, ...]) -> _Result:
    """Keep the forests of a job from starting threads: every core has a job already."""
    with parallel_config(backend="sequential"):
        return work(*item)


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Block Ctrl-C, which goes to every process of a terminal: the parent's answer is enough."""
    if sys.platform == "win32":  # which has no masks
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _backend(dask: str | None) -> Iterator[None]:
    """Run joblib's work on this machine's cores, or on the cluster of a Dask scheduler.

    Raises UsageError if no scheduler answers.
    """
    if dask is None:
        with parallel_config(backend="loky"):
            yield
        return
    from distributed import Client

    try:
        client = Client(dask, timeout=_CONNECT_S)
    except (OSError, ValueError) as error:
        raise UsageError(
            f"--dask {dask}: no scheduler answers ({error}): start one with `dask scheduler`, and "
            "`dask worker ADDRESS` on each machine that has springpot"
        ) from None
    with client, parallel_config(backend="dask"):
        yield


def cache_key(*values: object) -> str:
    """Return a hash of JSON values: the name of their entry in the cache."""
    return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()[:24]


def code_hash() -> str:
    """Return SHA-256 of springpot's sources: another version measures again."""
    root = Path(str(resources.files("springpot")))
    digest = hashlib.sha256()
    for floor in ("runtime_c", "codegen", "trainer", "host"):
        for file in sorted((root / floor).rglob("*")):
            if file.is_file() and "__pycache__" not in file.parts:
                digest.update(f"{file.relative_to(root).as_posix()}\n".encode() + file.read_bytes())
    return digest.hexdigest()


def holdout(recordings: Sequence[Recording], seed: int) -> tuple[list[Recording], list[Recording]]:
    """Split into training and validation: a fifth of the recordings, or the end of a single one.

    The recording with the maximum force stays: without it, validation measures extrapolation.
    """
    if len(recordings) == 1:
        cut = 1.0 - 1.0 / _HOLDOUT
        return [cut_recording(recordings[0], 0.0, cut)], [cut_recording(recordings[0], cut, 1.0)]
    strongest = int(np.argmax([recording.force_n.max() for recording in recordings]))
    others = [i for i in range(len(recordings)) if i != strongest]
    count = max(1, len(recordings) // _HOLDOUT)
    chosen = set(np.random.default_rng(seed).choice(others, size=count, replace=False).tolist())
    training = [recording for i, recording in enumerate(recordings) if i not in chosen]
    return training, [recording for i, recording in enumerate(recordings) if i in chosen]


def cut_recording(recording: Recording, begin: float, end: float) -> Recording:
    """Return the samples between two shares of a recording's length."""
    n = len(recording.force_n)
    rows = slice(round(begin * n), round(end * n))
    return replace(
        recording,
        name=f"{recording.name}, {100 * begin:.0f} to {100 * end:.0f} %",
        position_m=recording.position_m[rows],
        force_n=recording.force_n[rows],
        channels={},
        session="",  # what is left of a session has gaps
    )
