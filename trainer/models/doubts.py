"""Doubts about data and fit: no dependence, guessed memory, missed presses, recordings unlike."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.linalg import qr

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.errors import DataError, SpringpotError
from springpot.codegen.messages import notice
from springpot.codegen.model.model import Model
from springpot.trainer.features import highpass
from springpot.trainer.models.fit import Fit, FitOptions
from springpot.trainer.models.folds import N_FOLDS, split_by_condition
from springpot.trainer.models.predict import predict_each_n
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.quality.repeats import find_noise_floor
from springpot.trainer.recordings.recording import Recording

# Of the largest force, in held-out presses, a training recording, or those of --validate: what is
# warned of, and what is no model.
_WARN_MISFIT_FRACTION, _MAX_MISFIT_FRACTION = 0.15, 0.3
_MAX_FORCE_RATIO, _FELT_FORCE_FRACTION = (
    1.15,
    0.05,
)  # times the force of another recording; of the largest force
# Samples: a model is chosen on held-out fifths, of ten samples then; a springpot, of four numbers,
# is not chosen.
_MIN_ROWS, _MIN_ROWS_OF_SPRINGPOT = 50, 10
# Correlation of a position with itself some samples later: of noise alone 0.3 or less in 300
# samples, of a motion more at one of them, if it is sampled four times a cycle or stands at all.
_MAX_NOISE_CORRELATION, _NOISE_LAGS = 0.3, 8
# Of the force's variance, by a curve over depth or its change on parts that were held out: of noise
# and of random walks below 0.01, of a pad under noise twice as large as its force 0.16, of steps
# that relax 0.8 and more. And by the passive part, which follows a hold too: of noise below 0.1.
_MIN_EXPLAINED, _MIN_PASSIVE, _CURVE_BINS, _CURVE_PARTS = 0.1, 0.5, 20, 100
_HELD_OUT = "presses that were held out are missed"
_MIN_WINDOWS = 3  # a recording shorter than this many windows shows too little of their memory


def require_trainable(
    data: TrainingSet, recordings: Sequence[Recording], kind: str, options: FitOptions
) -> None:
    """Raise DataError for too few samples, and for positions that are noise.

    recordings: as they were measured: smoothed noise is no noise. kind: that is fitted.
    """
    fewest = _MIN_ROWS_OF_SPRINGPOT if kind == "springpot" else _MIN_ROWS
    rows, name = len(data.rows(options.fraction, options.seed)), data.recordings[0].name
    if rows < fewest:
        of = "" if rows == data.rows_total else f" of {data.rows_total}"
        raise DataError(
            f"{name}: {rows}{of} samples are fitted in all, and {kind} needs {fewest}: record "
            "longer or at a higher rate" + (", or give a larger --fraction" if of else "")
        )
    if all(_is_noise(recording.position_m) for recording in recordings):
        raise DataError(
            f"{name}: each position is unlike the one before, in all recordings: noise, and no "
            "press: check the column, or record presses"
        )


def _is_noise(position_m: Samples) -> bool:
    """Tell whether a position is white noise: unlike itself at every lag of some samples."""
    moved_m = position_m - position_m.mean()
    whole = float(moved_m @ moved_m)
    return whole > 0.0 and all(
        abs(float(moved_m[lag:] @ moved_m[:-lag])) < _MAX_NOISE_CORRELATION * whole
        for lag in range(1, _NOISE_LAGS + 1)
    )


def _require_dependence(compared: "list[_Compared]", data: TrainingSet) -> None:
    """Raise DataError if neither a curve over depth nor the passive model follows the force.

    The curve alone would refuse a hold that relaxes, the passive model one that snaps through.
    """
    missed = sum(float(np.sum((one.force_n - one.predicted_n) ** 2)) for one in compared)
    whole = sum(float(np.sum((one.force_n - one.force_n.mean()) ** 2)) for one in compared)
    explained = _compute_explained(data)
    if compared and missed > (1.0 - _MIN_PASSIVE) * whole and explained < _MIN_EXPLAINED:
        raise DataError(
            f"{data.recordings[0].name}: force does not depend on position: a curve over depth and "
            f"direction explains {100.0 * max(explained, 0.0):.0f} % of its variance in all "
            "recordings: check the columns; --accept-misfit fits it all the same"
        )


def _compute_explained(data: TrainingSet) -> float:
    """Share of the force's variance that depth and direction explain on parts held out.

    By a curve of each recording: two gains do not hide it. Over the depth itself, and over its
    change, which a force that relaxes within a few samples of each step follows alone.
    """
    smoothed, shares = 2.0 * data.smooth_s / data.dt_s, []  # samples: parts share no noise
    for samples in (0, 10, 100):
        sums = []
        for depth_m, recording in zip(data.depths_m, data.recordings, strict=True):
            over_m = highpass(depth_m, samples * data.dt_s, data.dt_s) if samples else depth_m
            sums.append(_compare_with_curve(over_m, recording.force_n, smoothed))
        missed, whole = np.sum(sums, axis=0).tolist()
        shares.append(1.0 - missed / whole if whole else 0.0)
    return max(shares)


def _compare_with_curve(depth_m: Samples, force_n: Samples, shortest: float) -> tuple[float, float]:
    """Sum of squares that curves of depth, each way, leave on parts held out; and of the force."""
    inward, missed_n = np.gradient(depth_m) > 0.0, force_n - force_n.mean()
    whole = float(missed_n @ missed_n)
    # Folds by chance: presses that are in step with the parts are shown too.
    part = np.arange(len(depth_m)) // max(len(depth_m) // _CURVE_PARTS, int(shortest), 1)
    fold = np.random.default_rng(0).integers(N_FOLDS, size=part[-1] + 1)[part]
    edges_m = np.linspace(depth_m.min(), depth_m.max(), _CURVE_BINS + 1)
    bin_of, middle_m = np.digitize(depth_m, edges_m[1:-1]), 0.5 * (edges_m[1:] + edges_m[:-1])
    for held, way in product(range(N_FOLDS), (inward, ~inward)):
        shown, tested = way & (fold != held), way & (fold == held)
        count = np.bincount(bin_of[shown], minlength=_CURVE_BINS)
        if count.any():
            sum_n = np.bincount(bin_of[shown], force_n[shown], minlength=_CURVE_BINS)
            curve_n = sum_n[count > 0] / count[count > 0]
            predicted_n = np.interp(depth_m[tested], middle_m[count > 0], curve_n)
            missed_n[tested] = force_n[tested] - predicted_n
    return float(missed_n @ missed_n), whole


def find_fit_warnings(fit: Fit, data: TrainingSet, options: FitOptions) -> Iterator[str]:
    """Yield a line for each doubt, with what to do."""
    window_s = options.window_s
    if window_s is not None and data.longest_s < _MIN_WINDOWS * window_s:
        yield (
            f"--window-s {window_s:g}: the longest recording lasts {data.longest_s:.3g} s, under "
            f"{_MIN_WINDOWS} windows: memory that long is guessed, not learned; record longer holds"
        )
    # Refused later, and not of a map: there whole places are held out, guessed from neighbours.
    yield from judge_misfit(fit.model, _compute_misfit(fit, data), _HELD_OUT, accepted=True)


def judge_residual(
    fit: Fit, data: TrainingSet, recordings: Sequence[Recording], accepted: bool
) -> Fit:
    """Add what the residual in the training recordings says: metadata and warnings.

    recordings: as they were measured, which show the noise floor. Raises SpringpotError for a model
    that misses one by 30 % of the force, DataError for a force of something else, unless accepted.
    """
    # A session, and a single recording, began at rest, whatever state a new press begins with.
    joined = len(data.motions) < len(data.recordings) or len(data.recordings) == 1
    model = fit.model.with_start("rested") if joined else fit.model
    passive = fit.model.hammerstein
    compared = [] if passive is None or passive.places else _compare_with_passive(model, data)
    if not accepted:
        _require_dependence(compared, data)
    warnings = [*_compare_recordings(compared, data)] if fit.model.kind == "hammerstein" else []
    warnings += _force_step_message(compared, _peak_n(data))
    if len(data.recordings) == 1 and not split_by_condition(data, data.even_rows()):
        notice(
            f"{data.recordings[0].name}: one recording, of one depth and speed: the error on "
            "others is not known: record more"
        )
    pieces = [(recording, np.arange(len(recording.force_n))) for recording in data.recordings]
    errors_n = [
        recording.force_n - predicted_n
        for recording, predicted_n in zip(
            data.recordings, predict_each_n(model, pieces), strict=True
        )
    ]
    residual_n = rms(np.concatenate(errors_n))
    most_n, most = max((rms(error_n), k) for k, error_n in enumerate(errors_n))
    missed = f"{data.recordings[most].name}, a training recording, is missed"
    warnings += judge_misfit(fit.model, most_n / _peak_n(data), missed, accepted)
    worst = max(
        (rms(errors_n[k][begin : begin + length]), k, begin, length)
        for k, recording in enumerate(data.recordings)
        for length in [max(len(recording.force_n) // _RESIDUAL_BLOCKS, 1)]
        for begin in range(0, len(recording.force_n), length)
    )
    worst_n, number, begin, length = worst
    recording, rows = data.recordings[number], slice(begin, begin + length)
    large = np.abs(errors_n[number][rows]) >= 0.5 * np.abs(errors_n[number][rows]).max()
    depths_mm = 1e3 * recording.position_m[rows][large]
    where = (
        f"most, {100.0 * worst_n / _peak_n(data):.2g} %, in {recording.name} from "
        f"{begin * recording.dt_s:.3g} to {(begin + length) * recording.dt_s:.3g} s, at "
        f"{depths_mm.min():.3g} to {depths_mm.max():.3g} mm"
    )
    share = residual_n / _peak_n(data)
    metadata = {**fit.metadata, "residual_n": residual_n, "residual_where": where}
    floor = find_noise_floor(recordings)
    if floor.source in ("repeats", "cycles") and floor.rms_n and share > _RESIDUAL.share:
        times = residual_n / floor.rms_n
        if times > _RESIDUAL.times and not warnings:
            warnings.append(
                f"{fit.model.name}: misses its own recordings by {100.0 * share:.2g} % of the peak "
                f"force, {times:.0f} times their noise floor ({floor.words}), {where}: the object "
                "did something there that the model cannot do, or the recording is wrong"
            )
    return replace(fit, metadata=metadata, warnings=(*fit.warnings, *warnings))


def require_acceptable_misfit(fit: Fit, data: TrainingSet, accepted: bool) -> None:
    """Raise SpringpotError for a model that misses held-out presses by 30 % of the force."""
    accepted |= "places" in fit.metadata
    list(judge_misfit(fit.model, _compute_misfit(fit, data), _HELD_OUT, accepted))


def judge_misfit(model: Model, share: float, missed: str, accepted: bool) -> Iterator[str]:
    """Yield a warning from 15 % of the largest force on; from 30 % on raise it, unless accepted.

    missed: what the model misses by that share, as in "p1 is missed".
    """
    line = (
        f"{model.name}: {missed} by {100.0 * share:.0f} % of the largest force: {model.kind} "
        "cannot follow this object, or the recordings are not of one, or of one unit or zero: see "
        "`springpot check`"
    )
    if model.kind != "rf-fd":
        line += ", or compare --model rf-fd on recordings that it has not seen"
    if share > _MAX_MISFIT_FRACTION and not accepted:
        raise SpringpotError(f"{line}; --accept-misfit takes the model as it is")
    if share > _WARN_MISFIT_FRACTION:
        yield line


def _peak_n(data: TrainingSet) -> float:
    return max(abs(data.trained.max_n), abs(data.trained.min_n))


def _compute_misfit(fit: Fit, data: TrainingSet) -> float:
    """Share of the largest force by which held-out presses were missed; 0 if none was held out."""
    error_n: float = fit.metadata.get("cv_rmse_n") or 0.0
    return error_n / _peak_n(data) if error_n else 0.0


@dataclass(frozen=True)
class StepRule:
    """When the residual of a passive model shows a step of gain or of surface in a recording.

    The limits are those of 318 right fits and 200 with such a step: one right recording came above
    `ratio`, of 70 gains of 0.6 to 1.6 half are below it. `weak` is a second pair, for a step that
    is larger, and hidden by more that the model cannot follow.

    rows: of each recording, block means: more change nothing.
    on_fraction: of the peak: where model or measurement push by less nothing is compared.
    min_rows: fewer in contact show nothing.
    cuts: shares of the squared force at which a step may be.
    own_share: of the step that decay, pace and depth do not explain as well, at least.
    ratio, effect: what the step explains of the squared residual, over what is left; its size, RMS,
    over that of the model's force behind it.
    felt: of the set's peak: a smaller step is not felt.
    ends: shares of the recording: a first press settles, and a last one shows too little.
    """

    rows: int = 3000
    on_fraction: float = 0.02
    min_rows: int = 100
    cuts: tuple[float, ...] = tuple(np.linspace(0.12, 0.88, 39))
    own_share: float = 0.03
    ratio: float = 0.6
    effect: float = 0.05
    weak_ratio: float = 0.2
    weak_effect: float = 0.1
    felt: float = 0.02
    ends: tuple[float, float] = (0.1, 0.9)


@dataclass(frozen=True)
class ResidualRule:
    """When a residual over a noise floor of repeats or cycles is worth a line.

    Of 38 right sets with such a floor none was above both, at 20 times one, at 10 times four. The
    noise of a sensor alone says nothing: right models miss up to 4 000 times of it.
    """

    times: float = 25.0
    share: float = 0.02


_STEP, _RESIDUAL = StepRule(), ResidualRule()
_RESIDUAL_BLOCKS = 24  # of a recording, of which the one with the largest residual is named
_MOVED_FRACTION = 0.01  # of the stroke, by which the model's slope over depth is taken


@dataclass(frozen=True)
class ForceStep:
    """From `row` on, of `rows`, the force is `times` what equal motion gave before."""

    row: int
    rows: int
    times: float
    strength: float


@dataclass(frozen=True, eq=False)
class _Compared:
    """A recording beside the passive model, in block means (rows,): m, N, N and N a stroke."""

    recording: Recording
    depth_m: Samples
    force_n: Samples
    predicted_n: Samples
    slope_n: Samples


def _compare_with_passive(model: Model, data: TrainingSet) -> list[_Compared]:
    """Compare recordings with the passive model, which cannot follow two objects at a time."""
    model = replace(model, features=None, regressor=None, hammerstein_adds=True)
    stroke_m = max(data.trained.max_m - max(data.trained.min_m, 0.0), 1e-12)
    predicted_n = []
    for moved_m in (0.0, _MOVED_FRACTION * stroke_m):
        moved = [
            replace(recording, position_m=recording.position_m + moved_m)
            for recording in data.recordings
        ]
        pieces = [(recording, np.arange(len(recording.force_n))) for recording in moved]
        predicted_n.append(predict_each_n(model, pieces))
    compared = []
    for recording, still_n, moved_n in zip(data.recordings, *predicted_n, strict=True):
        samples = (recording.position_m, recording.force_n, still_n, moved_n)
        block = -(-len(still_n) // _STEP.rows)
        rows = len(still_n) // block
        x, f, p, q = (
            values[: rows * block].reshape(rows, block).mean(axis=1) for values in samples
        )
        compared.append(_Compared(recording, x, f, p, (q - p) / _MOVED_FRACTION))
    return compared


def find_force_step(
    depth_m: Samples, force_n: Samples, predicted_n: Samples, slope_n: Samples, peak_n: float
) -> ForceStep | None:
    """Find the row from which a recording's force differs at equal motion; None without one.

    A gain that changed, a slip, another object. The residual of a passive model is fitted by what
    an object may do - a curve over depth, also with the sign and size of speed; decay, as of
    softening, creep and warming; another pace - and then by a step of the model's force, or of its
    slope over depth, from some row on. Of each only what the former leave counts. Whether it was a
    gain or a shift cannot be told. depth_m, force_n, predicted_n, slope_n: (rows,), m, N, N, N a
    stroke. peak_n: of the set.
    """
    own_peak_n, rows = float(np.abs(force_n).max()), len(force_n)
    on = np.maximum(np.abs(predicted_n), np.abs(force_n)) > _STEP.on_fraction * own_peak_n
    work = np.cumsum(predicted_n**2)
    if np.count_nonzero(on) < _STEP.min_rows or work[-1] == 0.0:
        return None
    nuisance = _explain_residual(depth_m, predicted_n, slope_n, own_peak_n)[on]
    nuisance = nuisance / np.maximum(np.linalg.norm(nuisance, axis=0), 1e-300)
    basis, triangle, _ = qr(nuisance, mode="economic", pivoting=True)
    size = np.abs(np.diag(triangle))
    basis = basis[:, size > 1e-6 * size[0]]
    left_n = (force_n - predicted_n)[on]
    left_n = left_n - basis @ (basis.T @ left_n)
    whole, best = float(left_n @ left_n), None
    for row in np.searchsorted(work / work[-1], _STEP.cuts).tolist():
        behind = np.arange(rows) >= row
        for column in (predicted_n, slope_n):
            step = np.where(behind, column, 0.0)[on]
            new_part = step - basis @ (basis.T @ step)
            if new_part @ new_part < _STEP.own_share * (step @ step) or not step.any():
                continue
            factor = float(new_part @ left_n) / float(new_part @ new_part)
            explained = factor * float(new_part @ left_n)
            ratio = explained / max(whole - explained, 1e-12 * whole)
            after_n = rms(predicted_n[behind & on])
            effect_n = abs(factor) * rms(column[behind & on])
            if best is None or ratio > best[0]:
                best = ratio, effect_n / after_n if after_n else 0.0, effect_n, row, column, factor
    if best is None:
        return None
    ratio, effect, effect_n, row, column, factor = best
    strong = ratio > _STEP.ratio and effect > _STEP.effect
    strong |= ratio > _STEP.weak_ratio and effect > _STEP.weak_effect
    inside = _STEP.ends[0] < row / rows < _STEP.ends[1]
    if not strong or not inside or effect_n < _STEP.felt * peak_n:
        return None
    before_n = predicted_n[:row]
    gain = float(before_n @ force_n[:row]) / float(before_n @ before_n) if before_n.any() else 1.0
    by_shift = np.sign(factor) * effect * np.sign(float(np.median(slope_n[on])) or 1.0)
    times = 1.0 + (factor if column is predicted_n else float(by_shift)) / gain
    return ForceStep(row, rows, times, ratio * effect)


def _explain_residual(
    depth_m: Samples, predicted_n: Samples, slope_n: Samples, peak_n: float
) -> Samples:
    """Build columns of what an object may do that the model does not: (rows, columns)."""
    rows = len(depth_m)
    time, work = np.arange(rows) / rows, np.cumsum(predicted_n**2)
    work = work / work[-1]
    speed = np.gradient(depth_m)
    speed = speed / max(rms(speed), 1e-300)
    columns = [predicted_n, slope_n]
    columns += [predicted_n * np.log(time + 0.01), predicted_n * np.log(work + 0.01)]
    columns += [predicted_n * work, slope_n * np.log(time + 0.01)]
    for window in (max(rows // 20, 1), max(rows // 6, 1)):

        def average(values: Samples, window: int = window) -> Samples:
            return np.convolve(values, np.full(window, 1.0 / window), "same")

        pace = np.log(average(speed**2) + 0.001)
        columns += [predicted_n * pace, slope_n * pace, predicted_n * average(predicted_n) / peak_n]
    knots = np.unique(np.quantile(depth_m, np.linspace(0.0, 1.0, 7)))
    for hat in np.eye(len(knots)):
        near = np.interp(depth_m, knots, hat)
        columns += [near, near * np.tanh(speed), near * np.clip(speed, -3.0, 3.0)]
    return np.stack(columns, axis=1)


def _force_step_message(compared: list[_Compared], peak_n: float) -> Iterator[str]:
    """Warn of the recording with the clearest step of its force (`find_force_step`)."""
    steps = [
        (step, one.recording)
        for one in compared
        if (step := find_force_step(
            one.depth_m, one.force_n, one.predicted_n, one.slope_n, peak_n
        ))
    ]  # fmt: skip
    if steps:
        step, recording = max(steps, key=lambda item: item[0].strength)
        yield (
            f"{recording.name}: from {recording.duration_s * step.row / step.rows:.3g} s on, force "
            f"is about {step.times:.2g} times what equal motion gave before: another gain, a slip "
            "or another object: cut there, and train on one part"
        )


def _compare_recordings(compared: list[_Compared], data: TrainingSet) -> Iterator[str]:
    """Warn if one model of all recordings misses single ones: they are of different objects.

    Of 16 sets of one object, the factors that fit each recording's force best to the model of all
    differed by .3 % at most, of five specimens by 4 %; of eight sets with one recording of another
    object, 1.5 to 2.3 times as stiff, by 20 to 60 %.
    """
    factors, max_difference_n = {}, 0.0
    for comparison in compared if len(compared) > 1 else ():
        if comparison.predicted_n.any():
            work = float(comparison.predicted_n @ comparison.predicted_n)
            factor = float(comparison.predicted_n @ comparison.force_n) / work
            factors[comparison.recording.name] = factor
            difference_n = abs(factor - 1.0) * float(np.abs(comparison.predicted_n).max())
            max_difference_n = max(max_difference_n, difference_n)
    # A light press errs more, and nobody feels it.
    if len(factors) < 2 or max_difference_n < _FELT_FORCE_FRACTION * _peak_n(data):
        return
    softest, stiffest = (pick(factors, key=factors.__getitem__) for pick in (min, max))
    if factors[stiffest] > _MAX_FORCE_RATIO * factors[softest] > 0.0:
        yield (
            f"{stiffest}: at equal motion, its force is "
            f"{factors[stiffest] / factors[softest]:.2g} times that of {softest}: "
            "if they are of one object, place, unit and zero, the passive model "
            "cannot follow it: try --model rf-fd"
        )
