"""Measured force beside that of the C, drawn on axes of matplotlib."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from springpot.codegen.arrays import Samples, rms

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_forces(
    axes: "Axes", name: str, dt_s: float, measured_n: Samples, predicted_n: Samples
) -> None:
    """Draw both forces, (n,), N, against time."""
    time_s = dt_s * np.arange(len(measured_n))
    axes.plot(time_s, measured_n, color="black", lw=1.2, label="measured")
    axes.plot(time_s, predicted_n, color="tab:red", lw=1.0, ls="--", label="C")
    axes.set(xlabel="time, s", ylabel="force, N")
    axes.set_title(name, loc="left", fontsize=9)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, ncols=2)


def median_error(measured_n: Sequence[Samples], predicted_n: Sequence[Samples]) -> int:
    """Return the number of the recording that has the median RMSE."""
    pairs = zip(measured_n, predicted_n, strict=True)
    errors_n = [rms(predicted - measured) for measured, predicted in pairs]
    return int(np.argsort(errors_n)[len(errors_n) // 2])
