"""The look of every figure: sizes, colours, thinning, and SVG text without dates."""

import io
from typing import Any

from matplotlib.figure import Figure

# Distinct in colour, and in black and white by line style or lightness.
MEASURED, PREDICTED, ERROR, MUTED = "#1b1b1b", "#d1495b", "#2e6f95", "#888888"
STYLE: Any = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.hashsalt": "springpot",
    "svg.fonttype": "path",
}
SVG_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))


def stride(samples: int, max_points: int = 4000) -> int:
    """Every how many samples a curve is drawn through."""
    return max(1, -(-samples // max_points))


def svg_text(figure: Figure) -> str:
    """The figure as an SVG element: the same figure, the same text."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata=SVG_METADATA)
    svg = text.getvalue()
    return svg[svg.index("<svg") :]
