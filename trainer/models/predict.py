"""A model's own prediction on recordings: no guard, coupling or limits.

And whether a recording and a model mean the same by a position and a tick.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import singledispatch

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.errors import DataError
from springpot.codegen.model.forest import predict_forest_n, quantise_leaves, to_bins
from springpot.codegen.model.model import Model
from springpot.codegen.model.regressors import Expression, Forest, Linear, Rbf, Regressor
from springpot.codegen.stages.expressions import run_expression
from springpot.trainer.features import depth_features
from springpot.trainer.models.depths import compute_depth_m, join_motions
from springpot.trainer.models.passive.passive_force import simulate_passive
from springpot.trainer.recordings.recording import Recording, Site, Zero, format_site

_WARN_DEPTH_RATIO, WARN_SPEED_RATIO = (
    1.5,
    4.0,
)  # times the trained depth and speed: from here on a line warns
# Times the longest training recording: no branch is slower than that, so that a force which still
# relaxes then cannot be distinguished from one at rest.
_WARN_HOLD_RATIO = 2.0
_HOLD_BAND, _MIN_HOLD_DEPTH = 0.02, 0.1  # of the trained depth: a hold moves by less, and is deeper
SPEED_WINDOW_S = 0.01  # of motion to a speed: an encoder's step is no speed
_MAX_DEPTH_RATIO = 10.0  # and from here on it is refused: no extrapolation, but another unit


def predict_n(model: Model, recording: Recording) -> Samples:
    """Force along a recording's positions, (n,), N."""
    return predict_each_n(model, [(recording, np.arange(len(recording.position_m)))])[0]


def predict_each_n(model: Model, pieces: Sequence[tuple[Recording, Indices]]) -> list[Samples]:
    """Predict the force at rows of each recording, (rows,), N; a session's go on from each other.

    Features know each recording alone.
    """
    recordings = [recording for recording, _ in pieces]
    depths = [compute_depth_m(recording, model.contact) for recording in recordings]
    force_n = np.zeros(sum(len(rows) for _, rows in pieces))
    if model.features is not None and model.regressor is not None:
        values = [
            depth_features(model.features, depth, model.dt_s, rows)
            for depth, (_, rows) in zip(depths, pieces, strict=True)
        ]
        force_n += regressor_force(model.regressor, np.concatenate(values))
    if model.hammerstein is not None and model.hammerstein_adds:
        surface = model.contact == "surface"
        forces_n = [np.zeros(0)] * len(pieces)
        for motion in join_motions(recordings, depths, surface):
            first = motion.recordings[0]
            passive = replace(model.hammerstein, continues=model.continues_training(depths[first]))
            place_m = recordings[first].place_m
            reach_m = model.start_reach_m
            motion_force_n = simulate_passive(
                passive, motion, model.dt_s, surface, place_m, reach_m
            )[0]
            for number, start in zip(motion.recordings, motion.starts, strict=True):
                forces_n[number] = motion_force_n[start + pieces[number][1]]
        force_n += np.concatenate(forces_n)
    return np.split(force_n, np.cumsum([len(rows) for _, rows in pieces])[:-1])


@singledispatch
def regressor_force(regressor: Regressor, values: Samples) -> Samples:
    """Force of features (n, features), N, shape (n,). Each kind of regressor registers its own."""
    raise TypeError(f"{type(regressor).__name__} has no force: register it with regressor_force")


@regressor_force.register
def _forest_force(forest: Forest, values: Samples) -> Samples:
    features = values.astype(np.float32)
    if forest.quantisation is not None:
        features = to_bins(forest.quantisation, features)
    return predict_forest_n(forest, quantise_leaves(forest), features, np.float64)


@regressor_force.register
def _rbf_force(rbf: Rbf, values: Samples) -> Samples:
    system = rbf_columns(standardise(rbf, values), rbf.centers)
    force_n: Samples = system @ np.concatenate([rbf.weights_n, rbf.tail_n])
    return force_n


@regressor_force.register
def _linear_force(linear: Linear, values: Samples) -> Samples:
    return linear.intercept_n + values @ linear.weights_n


@regressor_force.register
def _expression_force(expression: Expression, values: Samples) -> Samples:
    return run_expression(expression, values)


def standardise(rbf: Rbf, features: Samples) -> Samples:
    """Clip features, (n, features), to their extremes, then to mean 0 and scale 1."""
    inside: Samples = np.clip(features, rbf.feature_min, rbf.feature_max)
    return (inside - rbf.mean) / rbf.scale


def rbf_columns(z: Samples, centers: Samples) -> Samples:
    """Rows of the linear system: |z - center|^3 for each center, 1, z. Shape (n, centers + 3)."""
    square = np.zeros((len(z), len(centers)))
    for i in range(z.shape[1]):
        square += np.square(z[:, i : i + 1] - centers[:, i])
    return np.concatenate([square * np.sqrt(square), np.ones((len(z), 1)), z], axis=1)


def predict_limited_n(model: Model, recordings: Sequence[Recording]) -> list[Samples]:
    """Predict the force along positions, (n,), N, in float64; never below 0 at a surface.

    Recordings of one session go on from each other. Raises DataError for positions ten times deeper
    than any training press.
    """
    for recording in recordings:
        if (depth_ratio := compute_depth_ratio(model, recording)) > _MAX_DEPTH_RATIO:
            deepest = float(np.max(np.abs(recording.position_m)))
            raise DataError(
                f"{recording.name}: position goes to {deepest:.4g} m, {depth_ratio:.3g} times the "
                f"trained {_span_m(model):.4g} m: give positions in metres, or correct the unit on "
                "import"
            )
    if not recordings:
        return []
    pieces = [(recording, np.arange(len(recording.position_m))) for recording in recordings]
    min_n = 0.0 if model.contact == "surface" else -np.inf
    return [np.maximum(force_n, min_n) for force_n in predict_each_n(model, pieces)]


def compute_start_errors_n(
    model: Model, rmse_n: Callable[[Model], float]
) -> dict[str, float | None]:
    """RMSE from either start, N: only a person knows how a recording begins. None: has no state."""
    continues_n = rmse_n(model.with_start("continues")) if model.has_state else None
    return {"rested": rmse_n(model.with_start("rested")), "continues": continues_n}


def find_extrapolation(model: Model, recording: Recording) -> Iterator[str]:
    """Yield a line where positions go deeper, or faster, than the force is known.

    Objects with a viscosity that saturates, pressed ten times faster than trained, were missed by
    26 to 39 % of the peak.
    """
    depth_m, ticks = (
        compute_depth_m(recording, model.contact),
        max(1, round(SPEED_WINDOW_S / recording.dt_s)),
    )
    fastest_m = float(np.abs(depth_m[ticks:] - depth_m[:-ticks]).max(initial=0.0))
    trained_m = model.trained.max_mps * ticks * recording.dt_s
    times_faster = fastest_m / trained_m if trained_m else 0.0
    times_deeper = compute_depth_ratio(model, recording)
    for ratio, limit, quantity in (
        (times_deeper, _WARN_DEPTH_RATIO, "depth"),
        (times_faster, WARN_SPEED_RATIO, "speed"),
    ):
        if ratio > limit:
            yield (
                f"{recording.name}: goes to {ratio:.3g} times the trained {quantity}: "
                "there the force is an extrapolation"
            )
    trained_s = model.provenance.get("longest_s")  # unknown of older models
    held_s = _longest_hold_s(model, depth_m, recording.dt_s)
    if trained_s is not None and held_s > _WARN_HOLD_RATIO * trained_s:
        yield (
            f"{recording.name}: holds still for {held_s:.3g} s, and the longest training recording "
            f"lasts {trained_s:.3g} s: the force after that is an extrapolation"
        )


def _longest_hold_s(model: Model, depth_m: Samples, dt_s: float) -> float:
    """Return how long the tool stays within a fiftieth of the trained depth, inside the object."""
    longest = 0
    u = (depth_m - (model.trained.max_m - _span_m(model))) / _span_m(model)
    for offset in (0.0, 0.5):  # a hold at the border of two bands is within one that is moved
        band = np.floor(np.maximum(u, 0.0) / _HOLD_BAND + offset)
        ends = np.flatnonzero(np.diff(band, append=np.nan))
        lengths = np.diff(ends, prepend=-1)
        longest = max(longest, int(lengths[u[ends] > _MIN_HOLD_DEPTH].max(initial=0)))
    return longest * dt_s


def find_moving_starts(model: Model, recordings: Sequence[Recording]) -> Iterator[str]:
    """Yield a line for each recording whose past is assumed: it begins in motion, or goes on."""
    positions_m = [recording.position_m for recording in recordings]
    for motion in join_motions(recordings, positions_m, model.contact == "surface"):
        first = recordings[motion.recordings[0]]
        if model.continues_training(compute_depth_m(first, model.contact)):
            yield (
                f"{first.name}: is taken to go on where the training recordings ended; if the "
                'object had rested before it, say so: start "rested"'
            )
        elif before_s := motion.starts[0] * first.dt_s:
            yield (
                f"{first.name}: begins in motion inside the object: its own later motion, "
                f"{before_s:.3g} s of it, is taken to have come before"
            )


def missing_place_message(model: Model, recording: Recording) -> str:
    """Say which place a recording without one is given of a map: forces differ from place to place.

    "" where the recording has a place, or the model no map.
    """
    passive = model.hammerstein
    if passive is None or passive.places is None or recording.place_m is not None:
        return ""
    return f"{recording.name}: has no place: {stiffest_place_message(passive.places.stiffest_m)}"


def stiffest_place_message(stiffest_m: Site) -> str:
    """Say what a map renders where nobody chose a place."""
    return (
        f"the force is that of the map's stiffest place, {format_site(stiffest_m)}: give place_m, "
        "or a recording that has its place"
    )


def compute_depth_ratio(model: Model, recording: Recording) -> float:
    """Compare how far a recording goes with the training presses: 1 is as far as they went.

    Above a surface is air, where every height gives 0 N; without one, either way counts.
    """
    trained = model.trained
    beyond_m = float(np.max(recording.position_m)) - trained.max_m
    if model.contact == "always":
        beyond_m = max(beyond_m, trained.min_m - float(np.min(recording.position_m)))
    return 1.0 + max(beyond_m, 0.0) / _span_m(model)


def _span_m(model: Model) -> float:
    above_m = model.trained.min_m if model.contact == "always" else 0.0
    return model.trained.max_m - above_m


def read_zero(model: Model) -> Zero:
    """Zero that an importer gave to the model's recordings.

    A preloaded object has no surface, whether or not it was moved. Models of old do not say.
    """
    zero: Zero = model.provenance.get("zero", "min" if model.contact == "always" else "none")
    return zero


def require_compatible(recording: Recording, model: Model, tick_s: float | None = None) -> None:
    """Raise DataError for another sampling rate, or another meaning of position 0.

    tick_s: of the scene, which may have a rate of its own; without one, the model's. A model that
    is exact at any rate takes slower recordings too, see `at_ticks`.
    """
    dt_s, owner = (model.dt_s, "model") if tick_s is None else (tick_s, "scene")
    ticks_between = recording.dt_s / dt_s
    slower = tick_s is not None and model.exact_at_any_rate and ticks_between > 1.0
    if not slower and abs(ticks_between - 1.0) > 1e-3:
        raise DataError(
            f"{recording.name} is sampled at {recording.rate_hz:g} Hz, the {owner} at "
            f"{1 / dt_s:g} Hz: import it from its source with --resample-hz {1 / dt_s:g}"
        )
    moved = read_zero(model) != "none"
    if (recording.zero != "none") != moved:
        raise DataError(
            f"{recording.name} was imported with --zero {recording.zero}, the model's recordings "
            f"{'with' if moved else 'without'} --zero first or min: import all the same way"
        )
