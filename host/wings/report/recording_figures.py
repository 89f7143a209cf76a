"""Force against position, of several recordings at once."""

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from springpot import Recording
from springpot.figures import stride

_MAX_POINTS = 6000
_MAX_SHOWN = 12


def draw_loops(axes: Axes, recordings: Sequence[Recording], rates: Sequence[float]) -> None:
    """Force against position; rates: of each recording, Hz."""
    travels = [float(np.ptp(recording.position_m)) for recording in recordings]
    distinct = sorted({round(np.log2(travel) * 2) for travel in travels if travel > 0})
    styles = ("-", "--", ":", "-.")
    low, high = min(rates), max(*rates, min(rates) * 1.001)
    for k, (recording, rate, travel) in enumerate(zip(recordings, rates, travels, strict=True)):
        step = stride(len(recording.position_m), _MAX_POINTS)
        share = np.log(rate / low) / np.log(high / low)
        amplitude = distinct.index(round(np.log2(travel) * 2)) if travel > 0 else 0
        axes.plot(
            recording.position_m[::step] * 1e3, recording.force_n[::step], lw=0.8,
            color=mpl.colormaps["viridis"](0.9 * share), ls=styles[amplitude % len(styles)],
            label=f"{rate:.3g} Hz, {travel * 1e3:.3g} mm" if k < _MAX_SHOWN else None,
        )  # fmt: skip
    axes.set(xlabel="position, mm", ylabel="force, N")
    axes.legend(frameon=False, fontsize=7, loc="upper left")


def rate_hz(metadata: dict[str, Any]) -> float:
    """Frequency of a recording's cycles, or one over its duration."""
    cycles = metadata["cycles"]
    return float(cycles["frequency_hz"] if cycles else 1.0 / metadata["duration_s"])
