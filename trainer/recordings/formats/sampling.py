"""From time-stamped samples to a recording: what is refused, and resampling on request."""

from dataclasses import replace
from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.plurals import number_of
from springpot.trainer.recordings.formats.missing_samples import (
    GAP_STEPS,
    RUN,
    at,
    require_finite,
    require_no_gaps,
    rounding_s,
)
from springpot.trainer.recordings.formats.raw_channels import RawChannels, without_odd_first
from springpot.trainer.recordings.formats.uneven_tail import last_even_sample, on_grid, tail_grid
from springpot.trainer.recordings.recording import Recording, Zero, zero_word

MIN_ROWS = 3
STEP_TOLERANCE = 0.01
MAX_UPSAMPLING = 20  # beyond it nearly every sample would be invented
# Mean steps over so many samples are compared too: a change of rate can hide in rounded stamps.
_DRIFT_STEPS = 100
_FEW = 0.1  # of the rows


def to_recording(
    raw: RawChannels, name: str, zero: Zero | None, resample_hz: float | None
) -> Recording:
    """Check the samples, resample them if `resample_hz` is given, subtract the zero.

    Raises DataError naming the row: not finite, time that stands still, goes back, has gaps or,
    without `resample_hz`, uneven steps before the file's end; too few rows; channels that are not
    three arrays of one shape (n,). What was done is kept in `details`.
    """
    _check_shapes(raw)
    require_finite(raw)
    _check_order(raw)
    if resample_hz is None:
        raw = without_odd_first(raw, _slack_s(raw, 1))
    require_no_gaps(raw)
    details = {**raw.details, "sampling": _sampling(raw)}
    given = {"position_m": raw.position_m, "force_n": raw.force_n}
    last_even = None if resample_hz else _last_even(raw)
    if last_even is not None:
        grid_s, details["sampling"]["tail"] = tail_grid(raw.time_s, last_even)
        details["sampling"]["tail"]["from_row"] = raw.line_of(last_even + 1)
        channels = {k: on_grid(raw.time_s, its, grid_s, last_even) for k, its in given.items()}
        dt_s = float(grid_s[-1] - grid_s[0]) / (len(grid_s) - 1)
    elif resample_hz is None:
        _check_even(raw)
        channels = given
        dt_s = float(raw.time_s[-1] - raw.time_s[0]) / (len(raw.time_s) - 1)
    else:
        grid_s = _grid(raw, resample_hz)
        channels = {k: np.interp(grid_s, raw.time_s, its) for k, its in given.items()}
        dt_s = 1.0 / resample_hz
        details |= {
            "resampled_hz": resample_hz,
            "resampled_by": "linear interpolation",
            "source_rows": len(raw.time_s),
            "source_median_step_s": float(np.median(np.diff(raw.time_s))),
        }
    position_m, force_n = channels.pop("position_m"), channels.pop("force_n")
    zero = zero_word(zero)
    if zero != "none":
        pick = np.min if zero == "min" else lambda samples: samples[0]
        details |= {
            "zero_position_m": float(pick(position_m)),
            "zero_force_n": float(pick(force_n)),
        }
        position_m, force_n = position_m - pick(position_m), force_n - pick(force_n)
    place_x_m, place_y_m = raw.place_m or (None, None)
    return Recording(
        name, position_m, force_n, dt_s, zero, source=raw.source, details=details,
        channels=channels, place_x_m=place_x_m, place_y_m=place_y_m,
    )  # fmt: skip


def _sampling(raw: RawChannels) -> dict[str, Any]:
    """Metadata about the time stamps that uniform samples no longer show."""
    steps_s = np.diff(raw.time_s)
    usual_s = float(np.median(steps_s))
    return {
        "median_step_s": usual_s,
        "shortest_step_s": float(steps_s.min()),
        "longest_step_s": float(steps_s.max()),
        "jitter_rms_s": float(np.sqrt(np.mean((steps_s - steps_s.mean()) ** 2))),
        "stamp_digit_s": raw.time_digit_s,
    }


def _last_even(raw: RawChannels) -> int | None:
    last_even = last_even_sample(raw.time_s, _slack_s(raw, 1), raw.time_digit_s + rounding_s(raw))
    if last_even is not None:
        channels = (raw.time_s, raw.position_m, raw.force_n)
        time_s, position_m, force_n = (samples[: last_even + 1] for samples in channels)
        _check_even(replace(raw, time_s=time_s, position_m=position_m, force_n=force_n))
    return last_even


def _slack_s(raw: RawChannels, span: int) -> float:
    usual_s = float(np.median(np.diff(raw.time_s)))
    return STEP_TOLERANCE * usual_s + (raw.time_digit_s + rounding_s(raw)) / span


def _check_shapes(raw: RawChannels) -> None:
    channels = {"time": raw.time_s, "position": raw.position_m, "force": raw.force_n}
    shapes = {name: np.shape(found) for name, found in channels.items()}
    arrays = all(isinstance(found, np.ndarray) for found in channels.values())
    if not arrays or raw.time_s.ndim != 1 or len(set(shapes.values())) > 1:
        told = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise DataError(f"{raw.source}: {told}: give three 1-D numpy arrays of one length")


def _check_order(raw: RawChannels) -> None:
    if len(raw.time_s) < MIN_ROWS:
        raise DataError(
            f"{raw.source}: {len(raw.time_s)} rows of numbers: a recording needs {MIN_ROWS} or more"
        )
    bad = np.flatnonzero(np.diff(raw.time_s) <= 0.0)
    if len(bad):
        usual_s = float(np.median(np.diff(raw.time_s)))
        # Of rows in disorder, or stamps that stand, the usual step says nothing.
        few = len(bad) < _FEW * len(raw.time_s)
        hz = _round_hz(1.0 / usual_s) if few else "RATE"
        rate = f"time='{hz}Hz'" if raw.in_python else f"--map time={hz}Hz"
        before_s, here_s = raw.time_s[bad[0]], raw.time_s[bad[0] + 1]
        what = "stands still at" if here_s == before_s else f"goes back from {before_s:.9g} s to"
        raise DataError(
            f"{at(raw, bad[0] + 1)}: time {what} {here_s:.9g} s "
            f"({number_of(len(bad), 'such row')}): correct the time stamps in the source, cut "
            f"it there or, where every row is one step, state the rate in place of the "
            f"column: {rate}"
        )


def _check_even(raw: RawChannels) -> None:
    median_s = float(np.median(np.diff(raw.time_s)))
    mean_hz, fine_hz = _rates_hz(raw)
    hz = fine_hz if fine_hz > GAP_STEPS * mean_hz else mean_hz  # of a logger that slows down
    remedy = f"nothing is resampled unasked, pass {_option(raw, _round_hz(hz))}"
    for span in (1, _DRIFT_STEPS):
        if span >= len(raw.time_s):
            continue
        steps_s = (raw.time_s[span:] - raw.time_s[:-span]) / span
        usual_s = median_s if span == 1 else float(np.mean(np.diff(raw.time_s)))
        slack_s = STEP_TOLERANCE * usual_s + (raw.time_digit_s + rounding_s(raw)) / span
        bad = np.flatnonzero(np.abs(steps_s - usual_s) > slack_s)
        if len(bad):
            what = "the time step" if span == 1 else f"the mean of the last {span} time steps"
            raise DataError(
                f"{at(raw, bad[0] + span)}: {what} is {steps_s[bad[0]]:.6g} s where "
                f"{usual_s:.6g} s is usual ({number_of(len(bad), 'such row')}): {remedy}"
            )


def _rates_hz(raw: RawChannels) -> tuple[float, float]:
    """Mean rate of the samples, and that of the tenth of the steps, a few together, that is finest.

    A stamp that is late makes one step long and the next one short.
    """
    few = min(RUN, len(raw.time_s) - 1)
    steps_s = (raw.time_s[few:] - raw.time_s[:-few]) / few
    mean_s = float(np.mean(np.diff(raw.time_s)))
    return 1.0 / mean_s, 1.0 / float(np.quantile(steps_s, 0.1))


def _grid(raw: RawChannels, rate_hz: float) -> Samples:
    span_s = float(raw.time_s[-1] - raw.time_s[0])
    source_hz = max(_rates_hz(raw))
    if rate_hz > MAX_UPSAMPLING * source_hz:
        raise DataError(
            f"{raw.source}: {rate_hz:g} Hz is more than {MAX_UPSAMPLING} times its own "
            f"{source_hz:.6g} Hz: give a lower {_option(raw)}"
        )
    # 1e-6 of a step: the last sample is kept when rounding puts it a hair before the grid's.
    count = int(span_s * rate_hz + 1e-6) + 1
    if count < MIN_ROWS:
        raise DataError(
            f"{raw.source}: {span_s:.6g} s at {rate_hz:g} Hz leave {number_of(count, 'sample')}: "
            f"give a higher {_option(raw)}"
        )
    grid_s: Samples = raw.time_s[0] + np.arange(count) / rate_hz
    return grid_s


def _round_hz(rate_hz: float) -> str:
    """A rate as a person states it: steps that vary have no more digits."""
    return f"{rate_hz:.0f}" if rate_hz >= 100.0 else f"{rate_hz:.3g}"


def _option(raw: RawChannels, rate_hz: str = "") -> str:
    """How the rate to resample at is given."""
    name, equals = ("resample_hz", "=") if raw.in_python else ("--resample-hz", " ")
    return f"{name}{equals}{rate_hz}" if rate_hz else name
