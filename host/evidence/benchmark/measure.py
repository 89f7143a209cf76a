"""A point measured: a model fitted, built, and run on recordings that it has not seen."""

import os
import time
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from springpot import Model, Recording, Scene, SpringpotError, read_model
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.model.model_file import model_bytes, model_hash
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.plan.plan import Plan
from springpot.codegen.plan.units import state_bytes
from springpot.codegen.scene import Coupling, Number, Runtime, Target
from springpot.host.evidence.benchmark.point import MODEL_SIZES, Point, Refused, Sizes
from springpot.host.metrics import accuracy
from springpot.host.native.compiler import CompilerError, compiler_version
from springpot.host.native.footprint import Footprint, measure_footprint
from springpot.host.native.machine import cpu_s, machine_metadata
from springpot.host.native.replay import Replay, replayed
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.toolchain import missing_tools, toolchain
from springpot.host.native.trial_build import built, written
from springpot.host.stability.small_signal import small_signal_map
from springpot.host.stiffness import slope_errors, slope_keys
from springpot.trainer.kinds import KINDS, Kind

if TYPE_CHECKING:
    from springpot import Fit
    from springpot.host.evidence.splits import Split
    from springpot.host.evidence.sweep import Candidate
    from springpot.trainer.models.training_set import TrainingSet

NAME = "bench"
HOT_REPEATS = 5


@dataclass(frozen=True)
class BenchRecordings:
    """Recordings to fit on, and to report on; the same ones wherever `key` is the same."""

    key: str
    training: tuple[Recording, ...] = field(compare=False)
    validation: tuple[Recording, ...] = field(compare=False)


@dataclass(frozen=True, eq=False)
class Job:
    """What a worker needs for one point; `key` names its files. kind: may be a user's own."""

    key: str
    kind: Kind
    candidate: "Candidate"
    data: BenchRecordings
    target: Target


@dataclass(frozen=True, eq=False)
class MeasuredPoint:
    """What a worker hands back; model: its file, None if it was refused."""

    point: Point | Refused
    model: bytes | None


def measure_sizes(job: tuple[Point, Path, Target]) -> Point:
    """Return a point with the sizes of its C on the target; job: point, its model file, target."""
    point, model_file, target = job
    return replace(point, **vars(target_sizes(read_model(model_file), point.number, target)))


def measure_point(job: Job) -> MeasuredPoint:
    """Fit, cross-validate, build and measure. A refusal is a point too, not an error."""
    candidate = job.candidate
    KINDS.setdefault(job.kind.name, job.kind)  # a kind that was added by hand elsewhere
    stated: dict[str, Any] = {
        "key": job.key,
        "model": candidate.kind,
        "options": candidate.named_options(),
    }
    begin, cpu = time.perf_counter(), cpu_s()
    try:
        fit, metadata = _fitted(job)
        metadata |= _measured(job, fit.model)
    except SpringpotError as error:
        return MeasuredPoint(Refused(**stated, error=str(error)), None)
    spent: dict[str, Any] = {
        "point_s": time.perf_counter() - begin,
        "point_cpu_s": cpu_s() - cpu,
        "worker": f"{machine_metadata()['processor']}, process {os.getpid()}",
    }
    return MeasuredPoint(Point(**stated, **metadata, **spent), model_bytes(fit.model))


def bench_scene(number: Number, target: Target = "host") -> Scene:
    """Return the model and its guards, without a coupling: what the recordings can check."""
    return Scene(
        schema=1,
        name=NAME,
        model="model.spm",
        runtime=Runtime(number=number, target=target),
        coupling=Coupling(mode="off"),
    )


def _fitted(job: Job) -> tuple["Fit", dict[str, Any]]:
    from springpot.host.evidence.splits import cross_validated_rmse_n
    from springpot.trainer.kinds import fit_kind

    candidate, options = job.candidate, job.candidate.options
    whole, folds = _prepared(job.data, options.smooth_s, options.seed)
    fit = fit_kind(candidate.kind, NAME, whole, options)
    metadata = {
        "number": candidate.number,
        "engine": fit.model.engine,
        "window_s": fit.model.memory_s,
        "orders": list(fit.model.orders),
        "any_rate": fit.model.exact_at_any_rate,
        "rows": fit.rows,
        "feature_s": fit.feature_s,
        "fit_s": fit.fit_s,
        "search_s": fit.search_s,
        "cv_rmse_n": cross_validated_rmse_n(candidate.kind, folds, options),
        "hash": model_hash(fit.model),
    }
    return fit, metadata | {
        name: fit.metadata[name] for name in MODEL_SIZES if name in fit.metadata
    }


@lru_cache(maxsize=1)
def _prepared(
    data: BenchRecordings, smooth_s: float, seed: int
) -> tuple["TrainingSet", tuple["Split", ...]]:
    """Prepare the training recordings and their folds once: all points of a worker share them."""
    from springpot.host.evidence.splits import recording_splits
    from springpot.trainer.models.training_set import training_set

    return training_set(data.training, smooth_s), recording_splits(data.training, smooth_s, seed)


def _measured(job: Job, model: Model) -> dict[str, Any]:
    number = job.candidate.number
    plan = make_plan(model, bench_scene(number), accept_unsafe=True)
    with built(plan) as library:
        return {
            **prediction_errors(plan, library, job.data.validation),
            "tick_ns_hot": hot_ns(plan, library, job.data.validation),
            **vars(target_sizes(model, number, job.target)),
            "ram_bytes": state_bytes(plan),
            "left_out": [vars(item) for item in plan.left_out],
            **small_signal_map(plan, library, 0).as_dict(),
        }


def prediction_errors(
    plan: Plan,
    library: SceneLibrary,
    recordings: tuple[Recording, ...],
    before: tuple[Recording, ...] = (),
) -> dict[str, Any]:
    """Return error of the C on recordings; those of one session after the ones `before`."""
    forces_n, ramps = replayed(plan, Replay(library), [*before, *recordings])
    forces_n, ramps = forces_n[len(before) :], ramps[len(before) :]
    found = accuracy([recording.force_n for recording in recordings], forces_n, ramps)
    return {
        "rmse_n": found.rmse_n,
        "rmse_percent_of_peak": found.rmse_percent_of_peak,
        "mean_recording_rmse_n": found.mean_recording_rmse_n,
        "mean_recording_rmse_interval_n": found.interval_n and list(found.interval_n),
        "p99_abs_error_n": found.p99_abs_error_n,
        "max_abs_error_n": found.max_abs_error_n,
        "ape_below_jnd": found.ape_below_jnd,
        "error_per_jnd": found.error_per_jnd,
        **slope_keys(slope_errors(recordings, forces_n, ramps)),
    }


def hot_ns(plan: Plan, library: SceneLibrary, recordings: tuple[Recording, ...]) -> float:
    """Return median time of a tick on the longest recording, in a tight loop; the lowest of five.

    The sweep keeps all cores busy, and other programs may use them too.
    """
    longest = max(recordings, key=lambda recording: len(recording.position_m))
    position = longest.position_m.astype(plan.dtype)
    velocity = backward_velocity(position, plan.dt_s)
    return min(Replay(library).hot_ns(position, velocity) for _ in range(HOT_REPEATS))


def target_sizes(model: Model, number: Number, target: Target) -> Sizes:
    """Return flash and stack of the model's C on its target."""
    compiler = target_compiler(target)
    if why := missing_tools(target):
        return Sizes(why=why, sizes_compiler=compiler)
    try:
        size = _footprint(make_plan(model, bench_scene(number, target), accept_unsafe=True))
    except CompilerError as error:
        return Sizes(why=str(error), sizes_compiler=compiler)
    return Sizes(size.flash_bytes, size.stack_bytes, sizes_compiler=compiler)


def target_compiler(target: Target) -> str | None:
    """Return version of the target's compiler; None if it is not installed."""
    tools = toolchain(target)
    return None if tools is None else compiler_version(tools.compiler)


def _footprint(plan: Plan) -> Footprint:
    tools = toolchain(plan.scene.runtime.target)
    assert tools is not None, "the caller has looked"
    with written(plan) as folder:
        return measure_footprint(folder, f"{plan.scene.runtime.prefix}.c", tools)
