"""The look of every figure: sizes, colours, thinning, and SVG text without dates."""

import io
from typing import Any

import numpy as np
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

# Distinct in colour, and in black and white by line style or lightness.
MEASURED, PREDICTED, ERROR, MUTED = "#1b1b1b", "#d1495b", "#2e6f95", "#888888"
STYLE: Any = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.hashsalt": "springpot",
    "svg.fonttype": "path",
}
_PLAIN = (1e-4, 1e7)
SVG_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))


def stride(samples: int, max_points: int = 4000) -> int:
    """Every how many samples a curve is drawn through."""
    return max(1, -(-samples // max_points))


def log_ticks(axis: Axis) -> None:
    """Write plain numbers on a logarithmic axis on which all is drawn: the wider, the fewer.

    Where these would be long, powers of ten stay.
    """
    low, high = axis.get_view_interval()
    if low < _PLAIN[0] or high > _PLAIN[1]:
        return
    decades = np.log10(high / low)
    fits = {0.7: (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0), 1.5: (1.0, 2.0, 5.0), 4.0: (1.0, 3.0)}
    subs = next((subs for most, subs in fits.items() if decades < most), (1.0,))
    axis.set_major_locator(LogLocator(subs=subs))
    axis.set_major_formatter(lambda value, _: f"{value:.10g}")
    axis.set_minor_formatter(NullFormatter())


def svg_text(figure: Figure) -> str:
    """The figure as an SVG element: the same figure, the same text."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata=SVG_METADATA)
    svg = text.getvalue()
    return svg[svg.index("<svg") :]
