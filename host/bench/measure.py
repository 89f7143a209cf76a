"""One model measured: fitted, built, and run on recordings that it has not seen."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from springpot import Model, Recording, Scene, SpringpotError, read_model
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model_file import model_bytes, model_hash
from springpot.codegen.plan import Plan, state_bytes
from springpot.codegen.scene import Coupling, Number, Runtime, Target
from springpot.codegen.types import JsonObject
from springpot.host.bench.candidates import Candidate
from springpot.host.metrics import accuracy
from springpot.host.native.compiler import CompilerError, compiler_version
from springpot.host.native.footprint import measure_footprint
from springpot.host.native.replay import Replay, replayed
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.toolchain import missing_tools, toolchain
from springpot.host.native.trial_build import built, written
from springpot.host.stability.small_signal import small_signal_map
from springpot.host.stiffness import slope_errors, slope_keys

if TYPE_CHECKING:
    from springpot.trainer.models.training_set import TrainingSet

Point = JsonObject  # of one model: the keys of its row in bench.json
_HOT_REPEATS = 5


@dataclass(frozen=True)
class BenchRecordings:
    """Recordings to fit on, and to report on; the same ones wherever `key` is the same."""

    key: str
    training: tuple[Recording, ...] = field(compare=False)
    validation: tuple[Recording, ...] = field(compare=False)


def measure_point(
    candidate: Candidate, key: str, data: BenchRecordings
) -> tuple[Point, bytes | None]:
    """Return a model's row and its file; of a refused model `error`, and no file.

    key: of all that decides the result besides the candidate: joblib remembers by both.
    """
    stated: Point = {
        "model": str(candidate.file or candidate.kind),
        "options": candidate.named_options(),
    }
    try:
        model, fitted = _fitted(candidate, data)
        plan = make_plan(model, bench_scene(candidate.number), accept_unsafe=True)
        with built(plan) as library:
            found = {
                **prediction_errors(plan, library, data.validation),
                "tick_ns_hot": hot_ns(plan, library, data.validation),
                "ram_bytes": state_bytes(plan),
                **small_signal_map(plan, library, 0).as_dict(),
            }
    except SpringpotError as error:
        return stated | {"error": str(error)}, None
    return stated | fitted | found, model_bytes(model)


def _fitted(candidate: Candidate, data: BenchRecordings) -> tuple[Model, Point]:
    from springpot.trainer.kinds import fit_kind

    if candidate.file is not None:
        model = read_model(candidate.file)
        found: Point = {"rows": None, "fit_s": None}
    else:
        training = _prepared(data, candidate.options.smooth_s)
        fit = fit_kind(candidate.kind, "bench", training, candidate.options)
        model, found = fit.model, {"rows": fit.rows, "fit_s": fit.fit_s}
    return model, found | {
        "number": candidate.number,
        "engine": model.engine,
        "window_s": model.memory_s,
        "hash": model_hash(model),
    }


@lru_cache(maxsize=1)
def _prepared(data: BenchRecordings, smooth_s: float) -> "TrainingSet":
    """Prepare the training recordings once: all fits of a process share them."""
    from springpot.trainer.models.training_set import training_set

    return training_set(data.training, smooth_s)


def bench_scene(number: Number, target: Target = "host") -> Scene:
    """Return the model and its guards, without a coupling: what the recordings can check."""
    return Scene(
        schema=1,
        name="bench",
        model="model.spm",
        runtime=Runtime(number=number, target=target),
        coupling=Coupling(mode="off"),
    )


def prediction_errors(
    plan: Plan,
    library: SceneLibrary,
    recordings: Sequence[Recording],
    before: Sequence[Recording] = (),
) -> Point:
    """Return error of the C on recordings; those of one session after the ones `before`."""
    forces_n, ramps = replayed(plan, Replay(library), [*before, *recordings])
    forces_n, ramps = forces_n[len(before) :], ramps[len(before) :]
    found = accuracy([recording.force_n for recording in recordings], forces_n, ramps)
    return {
        "rmse_n": found.rmse_n,
        "rmse_percent_of_peak": found.rmse_percent_of_peak,
        "mean_recording_rmse_n": found.mean_recording_rmse_n,
        "mean_recording_rmse_interval_n": found.interval_n and list(found.interval_n),
        "max_abs_error_n": found.max_abs_error_n,
        "ape_below_jnd": found.ape_below_jnd,
        "error_per_jnd": found.error_per_jnd,
        **slope_keys(slope_errors(recordings, forces_n, ramps)),
    }


def hot_ns(plan: Plan, library: SceneLibrary, recordings: Sequence[Recording]) -> float:
    """Return median time of a tick on the longest recording, in a tight loop; the lowest of five.

    Fits keep all cores busy, and other programs may use them too.
    """
    longest = max(recordings, key=lambda recording: len(recording.position_m))
    position = longest.position_m.astype(plan.dtype)
    velocity = backward_velocity(position, plan.dt_s)
    return min(Replay(library).hot_ns(position, velocity) for _ in range(_HOT_REPEATS))


def target_compiler(target: Target) -> str | None:
    """Return version of the target's compiler; None if it is not installed."""
    tools = toolchain(target)
    return None if tools is None else compiler_version(tools.compiler)


def measure_sizes(
    model_file: Path, number: Number, target: Target, key: str, compiler: str | None
) -> Point:
    """Return bytes of flash and stack of a model's C on its target; null ones with `why`.

    key, compiler: hash of the model, version of the target's compiler: joblib remembers by both.
    """
    unknown: Point = {"flash_bytes": None, "stack_bytes": None}
    tools = toolchain(target)
    if tools is None:
        return unknown | {"why": missing_tools(target)}
    plan = make_plan(read_model(model_file), bench_scene(number, target), accept_unsafe=True)
    try:
        with written(plan) as folder:
            size = measure_footprint(folder, f"{plan.scene.runtime.prefix}.c", tools)
    except CompilerError as error:
        return unknown | {"why": str(error)}
    return {"flash_bytes": size.flash_bytes, "stack_bytes": size.stack_bytes, "why": None}
