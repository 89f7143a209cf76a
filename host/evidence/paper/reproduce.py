"""The paper's protocol on one object after the other: record, fit, emit, build, validate."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

from springpot import Model, Recording, Scene, validate, write_model
from springpot.codegen.arrays import Samples
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.scene import Coupling
from springpot.host.emission.emission import write_emission
from springpot.host.evidence.paper.past_positions import CONTROL, HandledModel, handled
from springpot.host.recording.protocols import RATE_HZ, load_protocol
from springpot.host.recording.session import open_press_device
from springpot.host.validation.validation import Validation

if TYPE_CHECKING:
    from springpot import Fit

PAPER_KINDS = ("rf-fd", "rbf-fd", "rbf-pv")
REPRODUCED_KINDS = (*PAPER_KINDS, "hammerstein", "hybrid")
_TRAINING_SEED, _VALIDATION_SEED = 1, 2
_BESIDE = 2  # validations at a time


@dataclass(frozen=True)
class Work:
    """How much is done. The defaults are the paper's; smaller ones are for trials.

    presses: every so many training presses is used. signals: validation signals.
    """

    kinds: tuple[str, ...] = REPRODUCED_KINDS
    trees: int = 100
    presses: int = 1
    signals: int = 10
    paced_s: float = 0.2


@dataclass(frozen=True, eq=False)
class ObjectRecordings:
    """Recordings of one object. commands_n: the commanded force of each training recording."""

    name: str
    training: tuple[Recording, ...]
    validation: tuple[Recording, ...]
    commands_n: tuple[Samples, ...] = ()

    @property
    def depth_m(self) -> float:
        return float(max(recording.position_m.max() for recording in self.training))


@dataclass(frozen=True, eq=False)
class Modelled:
    """One model of one object: its fit, its emitted folder, and its validation through the C."""

    fit: "Fit"
    folder: Path
    validation: Validation

    @property
    def modelling_s(self) -> float:
        """Features and training, s, as the paper counts it: without a search."""
        return self.fit.feature_s + self.fit.fit_s


@dataclass(frozen=True, eq=False)
class ObjectResult:
    """All models of one object, by kind; and the forests on derivatives and on past positions."""

    data: ObjectRecordings
    models: Mapping[str, Modelled]
    handled: Mapping[str, HandledModel]

    def rmse_n(self, kind: str) -> float:
        """Return RMSE averaged over the validation recordings (figure 9)."""
        return self.models[kind].validation.accuracy.mean_recording_rmse_n


def simulated(name: str, variant: str, work: Work) -> ObjectRecordings:
    """Record the paper's protocols on a simulated object. Raises UsageError for unknown names."""
    url = f"sim://{name}?variant={variant}"
    training = load_protocol("paper", _TRAINING_SEED)[:: work.presses]
    signals = load_protocol("validation", _VALIDATION_SEED)[: work.signals]
    recordings = []
    for seed, profiles in ((_TRAINING_SEED, training), (_VALIDATION_SEED, signals)):
        device = open_press_device(url, seed)
        recordings.append(
            tuple(
                Recording(f"{name}-{profile.name}", *device.press(profile.command_n), 1 / RATE_HZ,
                          source=url, details={"command": dict(profile.metadata)})
                for profile in profiles
            )
        )  # fmt: skip
    commands_n = tuple(profile.command_n for profile in training)
    return ObjectRecordings(name, recordings[0], recordings[1], commands_n)


def validators() -> ProcessPoolExecutor:
    """Return processes that validate, and put models into hands: the reference is Python."""
    return ProcessPoolExecutor(_BESIDE, mp_context=get_context("spawn"))


def begin_object(
    data: ObjectRecordings,
    fits: "Mapping[str, Fit]",
    folder: Path,
    work: Work,
    pool: ProcessPoolExecutor,
) -> Callable[[], ObjectResult]:
    """Write the C of every kind into `folder`, and let `pool` build and validate it.

    Return what waits for the result.
    """
    scene = plain_scene(data.name)
    folders = {kind: _written(kind, fits[kind].model, scene, folder) for kind in work.kinds}
    validations = {
        kind: pool.submit(validate, place, data.validation, paced_s=work.paced_s)
        for kind, place in folders.items()
    }
    hands = {kind: pool.submit(handled, fits[kind].model, scene) for kind in (CONTROL, "rf-fd")}

    def result() -> ObjectResult:
        models = {
            kind: Modelled(fits[kind], folders[kind], validation.result())
            for kind, validation in validations.items()
        }
        return ObjectResult(data, models, {kind: one.result() for kind, one in hands.items()})

    return result


def in_a_line(result: ObjectResult) -> str:
    """Return errors of all models."""
    errors = ", ".join(f"{kind} {result.rmse_n(kind):.3f}" for kind in result.models)
    return f"{result.data.name}: RMSE {errors} N"


def plain_scene(name: str, mode: str = "off") -> Scene:
    """Return a scene of the model alone, or with the paper's coupling."""
    return Scene(
        schema=1,
        name=name,
        model="model.spm",
        coupling=Coupling(mode="tool" if mode == "tool" else "off"),
    )


def model_metadata(model: Modelled) -> dict[str, Any]:
    """Return keys of one model in `reproduce.json`."""
    found = model.validation.accuracy
    return {
        "rmse_n": found.mean_recording_rmse_n,
        "rmse_interval_n": list(found.interval_n or ()),
        "p99_abs_error_n": found.p99_abs_error_n,
        "max_abs_error_n": found.max_abs_error_n,
        "ape_below_jnd": found.ape_below_jnd,
        "modelling_s": model.modelling_s,
        "search_s": model.fit.search_s,
        "tick_ns": model.validation.ticks.hot_median,
        "tick_paced_ns": model.validation.ticks.p50,
        "mismatches": model.validation.mismatches,
    }


def by_softness(results: Sequence[ObjectResult]) -> list[ObjectResult]:
    """Return objects from the softest, the one pressed deepest, to the hardest."""
    return sorted(results, key=lambda result: -result.data.depth_m)


def shown_object(results: Sequence[ObjectResult]) -> ObjectResult:
    """Return Ecoflex 00-50 as in the paper's figure 14, or the object of middle softness."""
    named = [result for result in results if result.data.name == "ecoflex-00-50"]
    return named[0] if named else by_softness(results)[len(results) // 2]


def fit_object(data: ObjectRecordings, work: Work) -> dict[str, "Fit"]:
    """Return all kinds, on one training set: what several hold is fitted once.

    Raises DataError where recordings do not fit together, or slide.
    """
    from springpot.trainer.kinds import fit_kind
    from springpot.trainer.models.fit import FitOptions
    from springpot.trainer.models.training_set import training_set

    options = FitOptions(trees=work.trees)
    prepared = training_set(data.training, options.smooth_s)
    return {
        kind: fit_kind(
            kind, data.name, prepared, options, data.validation if kind == "rbf-fd" else ()
        )
        for kind in (*work.kinds, CONTROL)
    }


def _written(kind: str, model: Model, scene: Scene, folder: Path) -> Path:
    """Return the model's C, which its validation builds: for replay, not for a hand or a board."""
    folder.mkdir(parents=True, exist_ok=True)
    model_file = folder / f"{kind}.spm"
    write_model(model_file, model)
    write_emission(make_plan(model, scene, accept_unsafe=True), scene, model_file, folder / kind)
    return folder / kind
