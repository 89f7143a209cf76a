"""Where an error lies: its one-sided part, and by the speed and the direction of the tool."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from springpot.basics import Samples
from springpot.validation import Series, rms

_EDGES = (0.0, 0.1, 0.3, 0.6, 1.0)  # of the speed that 99 % are below: one stroke is no range
_OVER_S = 0.01  # speed is a difference over this time, each way: a sample's step is mostly noise


@dataclass(frozen=True)
class SpeedError:
    """The samples of one range of speed: its ends (m/s), how many, and the error of the C (N).

    mean_in_n, mean_out_n: mean error while the tool goes in and while it comes out, None where it
    never does.
    """

    low_mps: float
    high_mps: float
    samples: int
    rmse_n: float
    mean_in_n: float | None
    mean_out_n: float | None


def errors_by_speed(series: Sequence[Series], ramps: Sequence[int]) -> list[SpeedError]:
    """Ranges of speed that hold samples, slowest first. ramps: samples of each not counted."""
    pairs = list(zip(series, ramps, strict=True))
    speed = np.concatenate([tool_speed(item)[ramp:] for item, ramp in pairs])
    error = np.concatenate([(item.predicted_n - item.measured_n)[ramp:] for item, ramp in pairs])
    size = np.abs(speed)
    top_mps = float(np.percentile(size, 99))
    found = []
    for low, high in pairwise(_EDGES):
        last = high == _EDGES[-1]
        inside = (size >= low * top_mps) & ((size < high * top_mps) | last)
        if inside.any():
            found.append(
                SpeedError(
                    low * top_mps, float(size.max()) if last else high * top_mps,
                    int(inside.sum()), rms(error[inside]),
                    _mean(error[inside & (speed > 0)]), _mean(error[inside & (speed < 0)]),
                )
            )  # fmt: skip
    return found


def tool_speed(item: Series) -> Samples:
    """Speed of the tool, (n,), m/s, over a few samples."""
    reach = max(1, round(_OVER_S / item.dt_s))
    padded = np.pad(item.position_m, reach, mode="edge")
    result: Samples = (padded[2 * reach :] - padded[: -2 * reach]) / (2.0 * reach * item.dt_s)
    return result


def _mean(values: NDArray[np.float64]) -> float | None:
    return float(values.mean()) if len(values) else None
