"""What is missing of time-stamped samples, and what to do about it."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from springpot.codegen.errors import DataError
from springpot.codegen.plurals import number_of
from springpot.trainer.recordings.formats.raw_channels import RawChannels

GAP_STEPS = 1.5  # a step longer than this many usual steps may be a gap
_MISSING = 0.5  # of a step: three in a row that are longer by more lack a sample
RUN = 5  # steps: so many alike are a rate; so few may be filled by hand
_MANY_STEPS = 30


def require_finite(raw: RawChannels) -> None:
    """Raise DataError for the first row that is not finite, with what to do about all of them."""
    channels = {"time": raw.time_s, "position": raw.position_m, "force": raw.force_n}
    for channel, samples in channels.items():
        bad = np.flatnonzero(~np.isfinite(samples))
        if len(bad):
            raise DataError(
                f"{at(raw, bad[0])}: {channel} is empty or not a finite number "
                f"({number_of(len(bad), 'such row')}): {_mend_rows(np.isfinite(samples))}"
            )


def _mend_rows(finite: NDArray[np.bool_]) -> str:
    """What to do about the rows that are not finite."""
    cut = "cut those rows in the source"
    if not finite.any():
        return "no row has a number there: choose another column"
    steps = np.diff(np.flatnonzero(finite))
    if not len(steps) or steps.max() == 1:  # all at the ends
        return cut
    if steps.min() == steps.max():  # a channel that is sampled once in so many rows
        return f"{cut}: the other rows are evenly sampled"
    return _mend(int(steps.max()))


def _mend(steps: int) -> str:
    """What to do where samples are missing, `steps` of time at most from one to the next."""
    cut = "cut the recording there and import the parts"
    fill = (
        "fill what is missing in the source from the rows beside it, as pandas' interpolate() does"
    )
    return f"{fill}, or {cut}" if steps <= RUN else cut


def require_no_gaps(raw: RawChannels) -> None:
    """Raise DataError where samples are missing, with what to do about them."""
    steps_s = np.diff(raw.time_s)
    usual_s = float(np.median(steps_s))
    # Stamps rounded to about one step (70 Hz as 0.01, 0.03, 0.04, 0.06 s) have double steps all
    # along: where there are many, the mean is the better measure of what is usual.
    if len(steps_s) >= _MANY_STEPS:
        usual_s = max(usual_s, float(np.mean(steps_s)))
    # A logger that slows down, as for a relaxation, has long steps; no step is much longer than the
    # one before, or the rate changes and each of the next ones is as long.
    before_s = np.append(usual_s, steps_s[:-1])
    after_s = sliding_window_view(np.append(steps_s[1:], np.zeros(RUN)), RUN).min(axis=1)
    known_s = np.maximum(usual_s, np.maximum(before_s, after_s))
    # A stamp that is late makes one step long and the next one short: no sample is missing.
    three_s = np.convolve(np.pad(steps_s, 1, constant_values=usual_s), np.ones(3), "valid")
    missing = three_s > (3.0 + _MISSING) * usual_s
    bad = np.flatnonzero((steps_s > GAP_STEPS * known_s + rounding_s(raw)) & missing)
    if len(bad):
        median_s = float(np.median(steps_s))
        longest = round(float(steps_s[bad].max()) / median_s)
        raise DataError(
            f"{at(raw, bad[0] + 1)}: gap of {steps_s[bad[0]]:.6g} s where steps are "
            f"{median_s:.6g} s ({number_of(len(bad), 'gap')}): {_mend(longest)}"
        )


def rounding_s(raw: RawChannels) -> float:
    """Return what the last bits of a double can add to a difference of two time stamps."""
    return 4.0 * float(np.spacing(np.abs(raw.time_s[[0, -1]]).max()))


def at(raw: RawChannels, sample: int | np.intp) -> str:
    """Write where a sample stands in its file."""
    return f"{raw.source}, row {raw.line_of(int(sample))}"
