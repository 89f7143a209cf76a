"""One call for each step of the job: record, train, predict, emit, stability, bench."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import TypeAdapter, ValidationError

from springpot.codegen.arrays import Samples, to_float64
from springpot.codegen.errors import DataError, UsageError, in_python, naming_missing_packages
from springpot.codegen.files import parse_path
from springpot.codegen.messages import notice
from springpot.codegen.model.model import Model
from springpot.codegen.model.passive import Start
from springpot.codegen.scene import Scene, Target
from springpot.codegen.types import JsonObject
from springpot.host.files import (
    File,
    given_model,
    given_scene_and_model,
    naming_unwritable_paths,
    read_recordings,
    some_recordings,
)
from springpot.trainer.models.fit import Engine, Fit, FitOptions
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_file import Recordings, resolve_recordings

if TYPE_CHECKING:
    from springpot.host.emission.result import Emission
    from springpot.host.stability.check import Stability


def record(
    url: str,
    protocol: File,
    folder: File,
    seed: int = 0,
    object_name: str = "object",
    max_force_n: float | None = None,
    max_depth_m: float = 0.03,
) -> list[Recording]:
    """Press an object with each force of a protocol; one recording of each, in `folder`.

    A folder that has them all already, of the same url, seed and protocol, is read.

    url: of a device, "sim://ecoflex-00-30" a simulated one. protocol: "paper" or another that
    docs/reference/recordings.md lists, or a TOML file. seed: of random commands and of a
    simulated device's noise. object_name: what lies under a real device. max_force_n, N (by
    default 1.3 x the command), and max_depth_m, m: beyond them it stops.
    Raises UsageError where files would be overwritten, DeviceError where the device fails.

    >>> presses = record("sim://ecoflex-00-30", "paper", "presses")
    >>> len(presses)
    27
    """
    from springpot.host.recording.indentation import Limits
    from springpot.host.recording.protocols import load_protocol
    from springpot.host.recording.session import open_press_device, record_session, recorded_before

    out = parse_path(folder)
    profiles = load_protocol(str(protocol), seed)
    device = open_press_device(url, seed, object_name, Limits(max_force_n, max_depth_m))
    if found := recorded_before(device, url, str(protocol), profiles, out):
        notice(f"{out}: has these recordings already: read, and nothing is pressed")
        return found
    presses = record_session(device, url, str(protocol), profiles, out)
    return read_recordings(*(press.file for press in presses))


@naming_missing_packages()
def train(
    recordings: Recordings,
    kind: str = "auto",
    name: str = "",
    validation: Recordings = (),
    *,
    seed: int = FitOptions.seed,
    fraction: float | None = FitOptions.fraction,
    window_s: float | None = FitOptions.window_s,
    smooth_s: float | None = FitOptions.smooth_s,
    trees: int = FitOptions.trees,
    leaf: int = FitOptions.leaf,
    tree_rows: float = FitOptions.tree_rows,
    split_features: float = FitOptions.split_features,
    n_centers: int = FitOptions.n_centers,
    velocity_weight: float = FitOptions.velocity_weight,
    select: Literal["cv", "paper"] = FitOptions.select,
    engine: Engine | None = FitOptions.engine,
    round_features: bool = FitOptions.round_features,
    past_positions: bool = FitOptions.past_positions,
    orders: Sequence[float] | None = FitOptions.orders,
    poles: int = FitOptions.poles,
    accept_misfit: bool = FitOptions.accept_misfit,
) -> Fit:
    """Fit a model of a kind of `kind_names()`: the result's `model`.

    kind: "auto" takes the one of lowest cross-validated error.
    name: of the model; by default its kind.
    validation: other recordings, which decide with select="paper" only.
    seed: number that decides the random choice of rows and trees.
    fraction: share of the rows that are used; None: 0.2 from 20 000 rows on, all below.
    window_s: how long the fractional filters remember, s; None: 171 samples, 1000 s if recursive.
    smooth_s: zero-phase moving average of the training data, s; 0: none; None: 0.025, or less
    where that would bend the force by more than half its noise.
    trees: how many trees the forest of rf-fd has.
    leaf: how many rows the smallest leaf of a tree holds.
    tree_rows: share of the rows that each tree is fitted on; 1 as usual.
    split_features: share of the features that each split tries.
    n_centers: how many radial basis functions rbf-fd and rbf-pv have.
    velocity_weight: of the newest velocity in rbf-pv's moving average; 1: no average.
    select: how rbf-fd chooses its orders: by cross-validation, or as the paper on `validation`.
    engine: the fractional filters: taps (fir), the same from a few exponentials (fir-fast), or
    exponentials that are exact at any rate (recursive); None: fir, recursive if the window is long.
    round_features: fit the trees of rf-fd on features in 16-bit steps: faster C without search.
    past_positions: fit rf-fd on ten past positions, as its control: negative damping.
    orders: of the fractional derivatives, each 0 to 1; None: the paper's ten.
    poles: how many time constants hammerstein, and the passive part of every kind, may use.
    accept_misfit: take a model that misses 30 % of the largest force, or of noise.

    Raises UsageError for an unknown kind or an option's value, DataError for recordings that cannot
    be trusted, fit together or show an object, SpringpotError for a model that misses so much.

    >>> train(recordings, "rf-fd", trees=5, seed=1).model.kind
    'rf-fd'
    """
    options = _fit_options(locals())
    from springpot.host.quality import warn_of_quality
    from springpot.trainer.kinds import fit_model

    training = warn_of_quality(some_recordings(recordings)).checked
    fit = fit_model(kind, name or kind, training, options, resolve_recordings(validation))
    fit = replace(fit, warnings=tuple(map(in_python, fit.warnings)))
    for line in fit.warnings:
        warnings.warn(line, UserWarning, stacklevel=2)
    return fit


@naming_missing_packages()
def predict(
    model: Model | Fit | File,
    position_m: ArrayLike | Recording,
    dt_s: float | None = None,
    *,
    place_m: tuple[float, float] | None = None,
    start: Start = "auto",
) -> Samples:
    """Force of the model itself along positions (n,), m: (n,), N, in float64; >= 0 at a surface.

    position_m: also a `Recording`, which says its time step and zero itself. dt_s: time between
    samples, s, where it is known: another one than the model's is a DataError, and so are positions
    ten times deeper than the training presses, as in millimetres. A UserWarning says from 1.5 times
    the trained depth, and from 4 times the trained speed on, that the force is an extrapolation; of
    a recording, that its signs are no object's, or that it begins in motion; and that a model with
    a map was given no place. place_m: x and y, m; by default the recording's. start: "rested", with
    the object at rest; "continues", as the training presses left it; as those began by default.

    >>> predict(model, [0.0, 1e-3, 2e-3]).shape
    (3,)
    """
    from springpot.trainer.models.predict import (
        find_extrapolation,
        find_moving_starts,
        missing_place_message,
        predict_limited_n,
        read_zero,
        require_compatible,
    )
    from springpot.trainer.recordings.quality.signs import find_sign_refusals

    model = given_model(model)
    doubts = []
    if isinstance(position_m, Recording):
        recording = position_m if dt_s is None else replace(position_m, dt_s=dt_s)
        doubts += find_sign_refusals([recording])
    else:
        positions = to_float64(position_m, "position_m")
        if positions.ndim != 1:
            raise DataError(f"position_m: shape {positions.shape}: give (n,), one press at a time")
        step_s, still_n = model.dt_s if dt_s is None else dt_s, np.zeros_like(positions)
        recording = Recording("position_m", positions, still_n, step_s, read_zero(model))
    if place_m is not None:
        recording = replace(recording, place_x_m=place_m[0], place_y_m=place_m[1])
    require_compatible(recording, model)
    (force_n,) = predict_limited_n(model.with_start(start), [recording])
    doubts += [missing_place_message(model, recording), *find_extrapolation(model, recording)]
    for doubt in (*doubts, *find_moving_starts(model, [recording])):
        if doubt:
            warnings.warn(in_python(doubt), UserWarning, stacklevel=2)
    return force_n


def emit(
    folder: File,
    *,
    model: Model | Fit | File | None = None,
    scene: Scene | File | None = None,
    accept_unsafe: bool = False,
) -> "Emission":
    """Write C into `folder`, build it and run its self-test; an earlier emission is replaced.

    model: itself or a file; by default the scene's. scene: itself or a file; by default all keys
    have their defaults. accept_unsafe: take a scene that a hand would find unstable, for replay.
    Raises UsageError for either, UnsafeError where a hand would find the scene unstable, unless
    that is accepted, BudgetError where the C does not fit the scene's budget, MismatchError where
    it differs from its reference.

    >>> emit("c", model=model).folder.name
    'c'
    """
    from springpot.host.emission.emission import emit as emit_folder

    stated, chosen = given_scene_and_model(scene, model)
    with naming_unwritable_paths():
        emission = emit_folder(stated, chosen, parse_path(folder), accept_unsafe)
    for line in emission.notices:
        if line.startswith("warning: "):
            warnings.warn(in_python(line.removeprefix("warning: ")), UserWarning, stacklevel=2)
        else:
            notice(line)
    return emission


def stability(
    *, model: Model | Fit | File | None = None, scene: Scene | File | None = None
) -> "Stability":
    """Linear loop, small-signal maps, and a closed loop with three hands, through the C.

    model, scene: as of `emit`. `as_dict()["recommendation"]` of the result says it in words.

    >>> stability(model=model).recommendation.startswith("Stable in every hand")
    True
    """
    from springpot.codegen.make_plan import make_plan
    from springpot.host.stability.check import stability as check

    stated, chosen = given_scene_and_model(scene, model)
    return check(make_plan(chosen, stated, accept_unsafe=True))


@naming_missing_packages()
def bench(
    recordings: Recordings,
    validation: Recordings = (),
    *,
    out: File = "bench",
    target: Target = "cortex-m4f",
    models: Sequence[str] = (),
    seed: int = 0,
) -> JsonObject:
    """Measure every kind and size of model: error, run time and bytes of each, and the front.

    validation: other recordings; by default a fifth of `recordings` is not trained on. out: folder
    of the results; what is there is not computed again. target: board of which the flash is
    counted. models: kinds and files of models; by default every kind. Returns what `springpot
    bench --json` prints. Raises UsageError for an unknown kind.

    >>> bench(recordings, models=["hammerstein"])["points"][0]["model"]
    'hammerstein'
    """
    from springpot.host.bench.bench import Bench, holdout, run_bench
    from springpot.host.quality import warn_of_quality

    training = warn_of_quality(some_recordings(recordings)).checked
    testing = resolve_recordings(validation)
    if not testing:
        training, testing = holdout(training, seed)
    asked = Bench(tuple(training), tuple(testing), target, seed, tuple(models))
    with naming_unwritable_paths():
        result = run_bench(asked, parse_path(out), "springpot.bench")
    told = [{**refused, "error": in_python(refused["error"])} for refused in result["refused"]]
    return {**result, "refused": told}


def _fit_options(given: Mapping[str, object]) -> FitOptions:
    """Check the fields of FitOptions among `given`. Raises UsageError that names a wrong one."""
    options = {field.name: given[field.name] for field in fields(FitOptions)}
    try:
        return TypeAdapter(FitOptions).validate_python(options)
    except ValidationError as error:
        first = error.errors()[0]
        key, why, value = ".".join(map(str, first["loc"])), first["msg"], first["input"]
        raise UsageError(f"option {key}: {why} (found {value!r})") from None
