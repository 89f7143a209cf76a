"""The figure of `springpot material`: moduli against frequency, and relaxation."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from springpot.basics import Samples
from springpot.figures import ERROR, MEASURED, MUTED, PREDICTED, STYLE, svg_text

Dynamic = NDArray[np.complex128]
_LABELS = {"pa": "shear modulus, Pa", "npm": "stiffness, N/m"}


def moduli_figure(
    frequency_hz: Samples,
    law: Dynamic,
    prony: Dynamic,
    measured: Sequence[tuple[float, complex]],
    extrapolated: NDArray[np.bool_],
    relaxation: tuple[Samples, Samples],
    unit: str,
) -> str:
    """SVG text. law, prony: dynamic values at the frequencies, of which some are extrapolated;
    measured: frequency and value of each cyclic recording; relaxation: times (s), values."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2)
        for values, colour, name in ((law.real, PREDICTED, "storage"), (law.imag, ERROR, "loss")):
            known = np.where(extrapolated, np.nan, values)
            left.loglog(frequency_hz, values, color=colour, lw=0.8, ls=":")
            left.loglog(frequency_hz, known, color=colour, label=f"{name}, law")
        for part, marker in ((np.real, "o"), (np.imag, "s")):
            at = [point[0] for point in measured]
            seen = [float(part(point[1])) for point in measured]
            label = "measured" if part is np.real and measured else None
            left.loglog(at, seen, color=MEASURED, ls="none", marker=marker, ms=4.0, label=label)
        style = {"color": MUTED, "ls": "none", "marker": ".", "ms": 2.5}
        left.loglog(frequency_hz, prony.real, label="Prony series", **style)
        left.loglog(frequency_hz, prony.imag, **style)
        left.set_xlabel("frequency, Hz (dotted: no recording reaches it)")
        left.set_ylabel(_LABELS[unit])
        left.legend(frameon=False, fontsize=7)
        right.semilogx(*relaxation, color=PREDICTED)
        right.set_xlabel("time after a step, s")
        right.set_ylabel(f"relaxation, {_LABELS[unit]}")
        return svg_text(figure)
