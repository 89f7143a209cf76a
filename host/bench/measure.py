"""What the benchmark measures, and one model measured on recordings that it has not seen."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from springpot.codegen.errors import SpringpotError, UsageError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import model_bytes, model_hash
from springpot.codegen.native.compiler import CompilerError, compiler_version
from springpot.codegen.plan import Plan, state_bytes
from springpot.codegen.scene import Coupling, Number, Runtime, Scene, Target
from springpot.codegen.types import JsonObject
from springpot.host.files import read_model
from springpot.host.metrics import accuracy, find_contacts, slope_errors, slope_keys
from springpot.host.native.replay import Replay, replay_forces
from springpot.host.native.scene_library import SceneLibrary, build_and_load, emitted_folder_of
from springpot.host.native.toolchain import measure_footprint, toolchain
from springpot.host.stability.small_signal import small_signal_map
from springpot.trainer.kinds import KINDS
from springpot.trainer.models.fit import PAPER_CENTERS, FitOptions
from springpot.trainer.models.rf_fd import PAPER_TAPS
from springpot.trainer.recordings.recording import Recording

if TYPE_CHECKING:
    from springpot.trainer.models.training_set import TrainingSet

_CENTERS = (10, 20, 30, 60, PAPER_CENTERS, 200, 300)
Point = JsonObject  # of one model: the keys of its row in bench.json
_HOT_REPEATS = 5


@dataclass(frozen=True)
class Candidate:
    """One model: its kind and options to fit it with, or its file; the number type of its C."""

    kind: str
    options: FitOptions
    number: Number = "float32"
    file: Path | None = None

    def named_options(self) -> dict[str, object]:
        """Return options that differ from the defaults."""
        plain = asdict(FitOptions())
        named: dict[str, object] = {
            name: value for name, value in asdict(self.options).items() if value != plain[name]
        }
        return named | ({"number": self.number} if self.number != "float32" else {})


def default_sweep(dt_s: float, options: FitOptions, kinds: Sequence[str] = ()) -> list[Candidate]:
    """List every candidate of `kinds` (all by default); windows are in samples of dt_s.

    The paper's three models are among them: rf-fd, rbf-fd and rbf-pv with nothing named.
    """
    candidates = [*_forests(dt_s, options), *_others(options)]
    swept = {candidate.kind for candidate in candidates}
    candidates += [Candidate(kind, options) for kind in KINDS if kind not in swept]
    return [candidate for candidate in candidates if not kinds or candidate.kind in kinds]


def _forests(dt_s: float, options: FitOptions) -> Iterator[Candidate]:
    """Yield the forests of the sweep: trees and leaves, quantised features, windows, engines."""
    for leaf, counts in ((5, (5, 10, 20, 50, 100, 200, 300)), (20, (5, 10, 20, 50, 100))):
        for trees in counts:
            yield Candidate("rf-fd", replace(options, trees=trees, leaf=leaf))
    fast = replace(options, engine="fir-fast", round_features=True)
    for leaf in (5, 20):
        for trees in (5, 10, 30, 100):
            yield Candidate("rf-fd", replace(fast, trees=trees, leaf=leaf))
    small = replace(fast, trees=30, leaf=20)
    for length in (PAPER_TAPS // 4, 2 * PAPER_TAPS, 4 * PAPER_TAPS):
        yield Candidate("rf-fd", replace(small, window_s=length * dt_s))
    for window_s in (20 * PAPER_TAPS * dt_s, None):
        yield Candidate("rf-fd", replace(small, engine="recursive", window_s=window_s))
    yield Candidate("rf-fd", options, "float64")
    yield Candidate("rf-fd", replace(options, trees=30, leaf=20, past_positions=True))


def _others(options: FitOptions) -> Iterator[Candidate]:
    """Yield the other kinds of the sweep, each over its size: centres, poles."""
    for n_centers in _CENTERS:
        yield Candidate("rbf-fd", replace(options, n_centers=n_centers))
        yield Candidate("rbf-pv", replace(options, n_centers=n_centers))
    for engine in ("fir-fast", "recursive"):
        for n_centers in (30, PAPER_CENTERS):
            yield Candidate("rbf-fd", replace(options, n_centers=n_centers, engine=engine))
    yield Candidate("rbf-fd", options, "float64")
    for poles in (2, 4, 6, 8, 12, 16):
        yield Candidate("hammerstein", replace(options, poles=poles))
    yield Candidate("hammerstein", options, "float64")
    yield Candidate("springpot", options)


@dataclass(frozen=True)
class BenchRecordings:
    """Recordings to fit on, and to report on; the same ones wherever `key` is the same."""

    key: str
    training: tuple[Recording, ...] = field(compare=False)
    validation: tuple[Recording, ...] = field(compare=False)


def measure_point(
    candidate: Candidate, target: Target, key: str, data: BenchRecordings
) -> tuple[Point, bytes | None]:
    """Return a model's row and its file; of a refused model `error`, and no file.

    key: of all that decides the result besides candidate and target: joblib remembers by them.
    """
    stated: Point = {
        "model": str(candidate.file or candidate.kind),
        "options": candidate.named_options(),
    }
    try:
        model, fitted = _fitted(candidate, data)
        plan = make_plan(model, bench_scene(candidate.number), accept_unsafe=True)
        library = build_and_load(plan)
        figures = {
            **prediction_errors(plan, library, data.validation, data.training),
            "tick_ns_hot": hot_ns(library, data.validation),
            **small_signal_map(plan, library, 0).as_dict(),
            **measure_sizes(model, candidate.number, target),
        }
    except SpringpotError as error:
        return stated | {"error": str(error.args[0])}, None
    return stated | fitted | figures, model_bytes(model)


def _fitted(candidate: Candidate, data: BenchRecordings) -> tuple[Model, Point]:
    """Fit a candidate, or read its file; return the model, and what its row says of it."""
    from springpot.trainer.kinds import fit_kind

    if candidate.file is not None:
        model = read_model(candidate.file)
        point: Point = {"rows": None, "fit_s": None}
    else:
        training = _prepared(data, candidate.options.smooth_s)
        fit = fit_kind(candidate.kind, "bench", training, candidate.options)
        model, point = fit.model, {"rows": fit.rows, "fit_s": fit.fit_s}
    return model, point | {
        "number": candidate.number,
        "engine": model.engine,
        "window_s": model.memory_s,
        "hash": model_hash(model),
    }


@lru_cache(maxsize=1)
def _prepared(data: BenchRecordings, smooth_s: float | None) -> "TrainingSet":
    """Prepare the training recordings once: all fits of a process share them."""
    from springpot.trainer.models.training_set import build_training_set

    return build_training_set(data.training, smooth_s)


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
    """Return the error of a model's C on recordings; a session's go on after those `before`.

    As the object does, and as `train --validate` measures: an object that remembers its training
    presses is not at rest where the test goes on.
    """
    forces_n, ramps = replay_forces(plan, Replay(library), [*before, *recordings])
    forces_n, ramps = forces_n[len(before) :], ramps[len(before) :]
    contacts = find_contacts(recordings, plan.contact)
    errors = accuracy([recording.force_n for recording in recordings], forces_n, ramps, contacts)
    named = ("rmse_n", "rmse_percent_of_peak", "mean_recording_rmse_n", "max_abs_error_n",
             "ape_below_jnd", "error_per_jnd", "contact_below_jnd")  # fmt: skip
    return {
        **{name: getattr(errors, name) for name in named},
        "mean_recording_rmse_interval_n": errors.interval_n and list(errors.interval_n),
        **slope_keys(slope_errors(recordings, forces_n, ramps)),
    }


def hot_ns(library: SceneLibrary, recordings: Sequence[Recording]) -> float:
    """Return median time of a tick on the longest recording, in a tight loop; the lowest of five.

    Fits keep all cores busy, and other programs may use them too.
    """
    longest = max(recordings, key=lambda recording: len(recording.position_m))
    return min(Replay(library).hot_ns(longest.position_m) for _ in range(_HOT_REPEATS))


def target_compiler(target: Target) -> str | None:
    """Return version of the target's compiler; None if it is not installed."""
    tools = toolchain(target)
    return None if tools is None else compiler_version(tools.compiler)


def measure_sizes(model: Model, number: Number, target: Target) -> Point:
    """Return bytes of RAM, flash and stack of a model's C on `target`.

    What is not known is null, and `why` says why.
    """
    ram: Point = {"ram_bytes": None}
    try:
        plan = make_plan(model, bench_scene(number, target), accept_unsafe=True)
        ram = {"ram_bytes": state_bytes(plan)}
        with emitted_folder_of(plan) as folder:
            size = measure_footprint(folder, target)
    except (CompilerError, UsageError) as error:  # no compiler; a regressor that needs a PC
        return ram | {"flash_bytes": None, "stack_bytes": None, "why": str(error)}
    return ram | {"flash_bytes": size.flash_bytes, "stack_bytes": size.stack_bytes, "why": None}
