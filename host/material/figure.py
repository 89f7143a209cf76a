"""The figure of `springpot material`: moduli against frequency, and relaxation."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.host.plot_style import ERROR, MEASURED, PREDICTED, STYLE, svg_text

Dynamic = NDArray[np.complex128]
_LABELS = {"pa": "shear modulus, Pa", "npm": "stiffness, N/m"}


def moduli_figure(
    frequency_hz: Samples,
    law: Dynamic,
    prony: Dynamic,
    relaxation: tuple[Samples, Samples],
    unit: str,
) -> str:
    """SVG text. law, prony: dynamic values at the frequencies; relaxation: times (s), values."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 3.2), layout="constrained")
        left, right = figure.subplots(1, 2)
        left.loglog(frequency_hz, law.real, color=MEASURED, label="storage")
        left.loglog(frequency_hz, law.imag, color=PREDICTED, ls="--", label="loss")
        style = {"color": ERROR, "ls": "none", "marker": ".", "ms": 3.0}
        left.loglog(frequency_hz, prony.real, label="Prony series", **style)
        left.loglog(frequency_hz, prony.imag, **style)
        left.set_xlabel("frequency, Hz")
        left.set_ylabel(_LABELS[unit])
        left.legend(frameon=False)
        right.semilogx(*relaxation, color=MEASURED)
        right.set_xlabel("time after a step, s")
        right.set_ylabel(f"relaxation, {_LABELS[unit]}")
        return svg_text(figure)
