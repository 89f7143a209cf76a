"""From time-stamped samples to a recording: what is refused, and resampling on request.

Machines begin or end a test between two samples: a first row that alone is out of step is cut,
and last rows that are out of step are interpolated onto the steps before them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from springpot.codegen.arrays import Flags, Indices, Samples
from springpot.codegen.errors import DataError
from springpot.codegen.messages import counted_noun
from springpot.trainer.recordings.formats.units import Quantity, Unit
from springpot.trainer.recordings.recording import Recording

MIN_ROWS = 3
STEP_TOLERANCE = 0.01
MAX_UPSAMPLING = 20  # beyond it nearly every sample would be invented
_DRIFT_STEPS = 100  # a change of rate can hide in rounded stamps, but not in their mean
_GAP_STEPS = 1.5  # a step longer than this many usual steps may be a gap
_MISSING_STEP_FRACTION = 0.5  # of a step: three in a row that are longer by more lack a sample
_FILLED_STEPS, _FILLED_S = 5.0, 0.05  # a gap that may be interpolated: the longer of the two
_RUN_STEPS = 5  # steps: so many alike are a rate
_MIN_MEAN_STEPS = 30
_MAX_RESTART_FRACTION = 0.05  # of the rows: more that go back in time are no restarts
_EVEN_STEPS, _TAIL_SHARE = 20, 0.05  # steps before an uneven end, and its share of all


@dataclass(frozen=True, eq=False)
class RawChannels:
    """Time-stamped samples as a file has them, in SI units, unchecked.

    time_s, position_m, force_n: shape (n,), float64. rows: of the file, from 1, shape (n,).
    time_digit_s: one unit in the last printed digit of the time stamps; 0 if none was printed.
    source: file, for messages and for the recording. place_m: x and y.
    """

    time_s: Samples
    position_m: Samples
    force_n: Samples
    rows: Indices
    source: str
    time_digit_s: float = 0.0
    details: dict[str, Any] = field(default_factory=dict)
    place_m: tuple[float, float] | None = None

    def select(self, which: slice | Flags) -> "RawChannels":
        """Return some of the samples."""
        parts = {q: getattr(self, q)[which] for q in ("time_s", "position_m", "force_n", "rows")}
        return replace(self, **parts)

    def rounding_s(self) -> float:
        """Return what the last bits of a double can change of a step."""
        return 4.0 * float(np.spacing(np.abs(self.time_s[[0, -1]]).max()))

    def is_irregular(self, steps_s: Samples, usual_s: float = 0.0, span: int = 1) -> Flags:
        """Return which steps, means of `span` steps, are not the usual one (0: their median)."""
        usual_s = usual_s or float(np.median(steps_s))
        slack_s = STEP_TOLERANCE * usual_s + (self.time_digit_s + self.rounding_s()) / span
        return np.asarray(np.abs(steps_s - usual_s) > slack_s)

    def error_at(self, bad: Indices, first: int, what: str, remedy: str) -> DataError:
        """Return an error that names the first of the bad samples, or the one so many behind."""
        where, many = (
            f"{self.source}, row {self.rows[bad[0] + first]}",
            counted_noun(len(bad), "row"),
        )
        return DataError(f"{where}: {what} ({many} in all): {remedy}")


def to_si(
    values: Mapping[Quantity, Samples],
    units: Mapping[Quantity, Unit],
    rate_hz: float | None,
    guess: str = "",
    **others: Any,
) -> RawChannels:
    """Channels of one file; rate_hz: time is counted. others: fields of RawChannels.

    Raises DataError for channels that are not arrays of one shape (n,).
    """
    shapes = {quantity: np.shape(samples) for quantity, samples in values.items()}
    if len(shapes["force"]) != 1 or len(set(shapes.values())) > 1:
        sizes = ", ".join(f"{quantity} {shape}" for quantity, shape in shapes.items())
        raise DataError(f"{others['source']}: {sizes}: give three 1-D arrays of one length")
    scaled = {quantity: values[quantity] * unit.to_si for quantity, unit in units.items()}
    stated = {quantity: unit.metadata() for quantity, unit in units.items()}
    if rate_hz is not None:
        scaled["time"] = np.arange(len(scaled["force"])) / rate_hz
        stated["time"] = {"unit": f"{rate_hz:g} Hz", "from": "map"}
    details = {"columns": guess, "units": stated}
    channels = (scaled["time"], scaled["position"], scaled["force"])
    return RawChannels(*channels, details=details, **others)


def to_recording(raw: RawChannels, name: str, resample_hz: float | None) -> Recording:
    """Check the samples, and resample them if `resample_hz` is given.

    Raises DataError naming the row: not finite; time that stands still, goes back, has gaps or,
    without `resample_hz`, uneven steps before the file's end; too few rows. `details` says in
    `notes` which rows were left out, which gaps were filled, and whether the end was uneven.
    """
    raw, notes = _drop_unusable_rows(raw, resample_hz is not None)
    _require_samples(raw)
    steps_s = np.diff(raw.time_s)
    irregular = raw.is_irregular(steps_s)
    if (
        resample_hz is None
        and len(steps_s) > _EVEN_STEPS
        and irregular[0]
        and not irregular[1:].any()
    ):
        notes.append(
            f"row {raw.rows[0]} comes {steps_s[0]:.4g} s before the next one, where steps are "
            f"{np.median(steps_s):.4g} s: cut"
        )
        raw, steps_s = raw.select(slice(1, None)), steps_s[1:]
    gaps = _find_gaps(raw, steps_s, resample_hz is not None)
    if len(gaps):
        notes.append(
            f"{counted_noun(len(gaps), 'gap')} of up to {steps_s[gaps].max():.4g} s, the first "
            f"before row {raw.rows[gaps[0] + 1]}: interpolated"
        )
    sampling = {
        "longest_step_s": float(steps_s.max()),
        "shortest_step_s": float(steps_s.min()),
        "stamp_digit_s": raw.time_digit_s,
    }
    details = {**raw.details, "sampling": sampling, "notes": notes}
    if resample_hz is None:
        grid_s, even = _find_even_grid(raw, steps_s)
        dt_s = float(grid_s[-1] - grid_s[0]) / (len(grid_s) - 1)
        if even < len(raw.time_s):
            left_out_s = max(0.0, float(raw.time_s[-1]) - float(grid_s[-1]))
            notes.append(
                f"the end, {counted_noun(len(raw.time_s) - even, 'row')} from row {raw.rows[even]} "
                "on, is not in step with the rows before: interpolated onto their "
                f"{1.0 / dt_s:.6g} Hz, and the last {left_out_s:.3g} s left out"
            )
    else:
        grid_s, even, dt_s = _resample_grid(raw, resample_hz), 0, 1.0 / resample_hz
        details["resampled_hz"] = resample_hz
    position_m, force_n = (
        np.append(samples[:even], np.interp(grid_s[even:], raw.time_s, samples))
        for samples in (raw.position_m, raw.force_n)
    )
    place_x_m, place_y_m = raw.place_m or (None, None)
    return Recording(
        name, position_m, force_n, dt_s, source=raw.source, details=details,
        place_x_m=place_x_m, place_y_m=place_y_m,
    )  # fmt: skip


def _drop_unusable_rows(raw: RawChannels, fill: bool) -> tuple[RawChannels, list[str]]:
    """Leave out rows written twice, and with `fill` rows without a number; and say so."""
    notes, channels = list[str](), np.array([raw.time_s, raw.position_m, raw.force_n])
    numbers = np.asarray(np.isfinite(channels).all(axis=0))
    if fill and numbers.any() and not numbers.all():
        inside = np.flatnonzero(numbers)
        if ends := len(numbers) - 1 - int(inside[-1] - inside[0]):
            notes.append(f"{counted_noun(ends, 'row')} without a number at the ends: left out")
        raw, channels = raw.select(numbers), channels[:, numbers]
    steps = np.diff(channels, prepend=np.nan)
    new = np.asarray(np.any(steps != 0.0, axis=0))  # the first row too: NaN is not 0
    if repeats := int(np.count_nonzero(~new)):
        notes.append(f"{counted_noun(repeats, 'row')} left out, equal to the row before")
    return raw.select(new), notes


def _require_samples(raw: RawChannels) -> None:
    """Refuse what is no number, or not in the order of time, and too few rows."""
    channels = {"time": raw.time_s, "position": raw.position_m, "force": raw.force_n}
    for channel, samples in channels.items():
        bad = np.flatnonzero(~np.isfinite(samples))
        if len(bad):
            hz = f"{1.0 / np.nanmedian(np.diff(raw.time_s)):.4g}" if channel != "time" else "RATE"
            remedy = f"--resample-hz {hz} interpolates there, else import the parts"
            if len(bad) == len(samples):
                remedy = "no row has a number there: choose another column"
            raise raw.error_at(bad, 0, f"{channel} is empty or not a finite number", remedy)
    if len(raw.time_s) < MIN_ROWS:
        raise DataError(
            f"{raw.source}: {len(raw.time_s)} rows of numbers: a recording needs {MIN_ROWS} or more"
        )
    bad = np.flatnonzero(np.diff(raw.time_s) <= 0.0)
    if len(bad):
        before_s, here_s = raw.time_s[bad[0]], raw.time_s[bad[0] + 1]
        what = "stands still at" if here_s == before_s else f"goes back from {before_s:.9g} s to"
        remedy = (
            "correct the stamps in the source, cut it there or, if every row is one step, state "
            "the rate in place of the column: --map time=RATEHz"
        )
        if np.count_nonzero(np.diff(raw.time_s) < 0.0) > _MAX_RESTART_FRACTION * len(raw.time_s):
            remedy = "sort the rows by time in the source"
        raise raw.error_at(bad, 1, f"time {what} {here_s:.9g} s", remedy)


def _find_gaps(raw: RawChannels, steps_s: Samples, fill: bool) -> Indices:
    """Rows before which samples are missing, all of them short enough to be interpolated.

    Raises DataError for longer ones, and for any unless `fill`.
    """
    median_s = usual_s = float(np.median(steps_s))
    # Stamps rounded to about one step (70 Hz as 0.01, 0.03, 0.04, 0.06 s) have double steps all
    # along: of many, the mean is the better measure of the usual step.
    if len(steps_s) >= _MIN_MEAN_STEPS:
        usual_s = max(usual_s, float(np.mean(steps_s)))
    # A logger that slows down, as for a relaxation, has long steps; no step is much longer than the
    # one before, or the rate changes and each of the next ones is as long.
    before_s = np.append(usual_s, steps_s[:-1])
    after_s = sliding_window_view(np.append(steps_s[1:], np.zeros(_RUN_STEPS)), _RUN_STEPS).min(
        axis=1
    )
    accepted_s = np.maximum(usual_s, np.maximum(before_s, after_s))
    # A stamp that is late makes one step long and the next one short: no sample is missing.
    three_s = np.convolve(np.pad(steps_s, 1, constant_values=usual_s), np.ones(3), "valid")
    missing = three_s > (3.0 + _MISSING_STEP_FRACTION) * usual_s
    bad = np.flatnonzero((steps_s > _GAP_STEPS * accepted_s + raw.rounding_s()) & missing)
    too_long = bad[steps_s[bad] > max(_FILLED_STEPS * usual_s, _FILLED_S)]
    if len(too_long) or (len(bad) and not fill):
        first = (too_long if len(too_long) else bad)[0]
        what = f"gap of {steps_s[first]:.6g} s where steps are {median_s:.6g} s"
        remedy = "cut the recording there and import the parts"
        if not len(too_long):
            hz = f"{1.0 / median_s:.4g}"
            remedy = f"to interpolate there, pass --resample-hz {hz}, or {remedy}"
        raise raw.error_at(too_long if len(too_long) else bad, 1, what, remedy)
    return bad


def _find_even_grid(raw: RawChannels, steps_s: Samples) -> tuple[Samples, int]:
    """Return stamps on an even grid to the file's end, and how many of the file's fit it.

    Raises DataError if more than the end is out of step.
    """
    time_s, off = raw.time_s, raw.is_irregular(steps_s)
    # If the other rows are regular to the last printed digit, the first one out of step is found
    # exactly.
    digits_s = 1.5 * (raw.time_digit_s + raw.rounding_s())
    strictly_off = off | (np.abs(steps_s - np.median(steps_s)) > digits_s)
    for flags in (strictly_off, off) if off.any() else ():
        last = int(np.argmax(flags))
        if last >= _EVEN_STEPS and len(steps_s) - last <= max(1.0, _TAIL_SHARE * len(steps_s)):
            _require_even(raw.select(slice(last + 1)))
            begin_s = float(time_s[0])
            step_s = (float(time_s[last]) - begin_s) / last
            count = int((float(time_s[-1]) - begin_s) / step_s + 1e-6) + 1
            return begin_s + step_s * np.arange(count, dtype=np.float64), last + 1
    _require_even(raw)
    return time_s, len(time_s)


def _require_even(raw: RawChannels) -> None:
    """Raise DataError at the first step of time that is unlike the others, with a rate to pass."""
    mean_hz, fine_hz = _rates_hz(raw)
    hz = fine_hz if fine_hz > _GAP_STEPS * mean_hz else mean_hz  # of a logger that slows down
    for span in (1, _DRIFT_STEPS) if len(raw.time_s) > _DRIFT_STEPS else (1,):
        steps_s = (raw.time_s[span:] - raw.time_s[:-span]) / span
        usual_s = float(np.median(steps_s)) if span == 1 else 1.0 / mean_hz
        bad = np.flatnonzero(raw.is_irregular(steps_s, usual_s, span))
        if len(bad):
            what = "the time step" if span == 1 else f"the mean of the last {span} time steps"
            # A rate as a person states it: steps that vary have no more digits.
            rate = f"{hz:.0f}" if hz >= 100.0 else f"{hz:.3g}"
            raise raw.error_at(
                bad, span, f"{what} is {steps_s[bad[0]]:.6g} s where {usual_s:.6g} s is usual",
                f"nothing is resampled unasked, pass --resample-hz {rate}",
            )  # fmt: skip


def _rates_hz(raw: RawChannels) -> tuple[float, float]:
    """Mean rate of the samples, and that of the tenth of the steps, a few together, that is finest.

    A stamp that is late makes one step long and the next one short.
    """
    few = min(_RUN_STEPS, len(raw.time_s) - 1)
    steps_s = (raw.time_s[few:] - raw.time_s[:-few]) / few
    return 1.0 / float(np.mean(np.diff(raw.time_s))), 1.0 / float(np.quantile(steps_s, 0.1))


def _resample_grid(raw: RawChannels, rate_hz: float) -> Samples:
    """Time stamps at a rate."""
    span_s, source_hz = float(raw.time_s[-1] - raw.time_s[0]), max(_rates_hz(raw))
    # 1e-6 of a step: rounding may put the last sample a hair before the grid's.
    count = int(span_s * rate_hz + 1e-6) + 1
    if rate_hz > MAX_UPSAMPLING * source_hz or count < MIN_ROWS:
        wanted = "a higher" if count < MIN_ROWS else "a lower"
        raise DataError(
            f"{raw.source}: {rate_hz:g} Hz is more than {MAX_UPSAMPLING} times its own "
            f"{source_hz:.6g} Hz, or leaves fewer than {MIN_ROWS} samples: give {wanted} rate, "
            "--resample-hz RATE"
        )
    return np.asarray(raw.time_s[0] + np.arange(count) / rate_hz)
