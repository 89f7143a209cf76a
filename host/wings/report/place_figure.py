"""A map of the places that were validated: how far the C is off at each, and where most."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from springpot.figures import MEASURED, MUTED, PREDICTED, STYLE, svg_text
from springpot.validation import PlaceError

_SIDE = 4.4  # inches, of the longer one
_MOST_LABELLED = 49


def place_figure(
    errors: Sequence[PlaceError], extent_m: tuple[Sequence[float], Sequence[float]] | None
) -> str:
    """Draw the places from above, each with its RMSE in % of its peak; the worst has a ring.

    extent_m: ends of the scene's map along x and y, if it has one. Empty for fewer than two places.
    """
    if len(errors) < 2:
        return ""
    x_mm, y_mm = 1e3 * np.array([error.place_m for error in errors]).T
    percent = np.array([error.rmse_percent_of_peak for error in errors])
    worst = int(percent.argmax())
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(_SIDE + 0.6, _SIDE), layout="constrained")
        axes = figure.subplots()
        if extent_m is not None:
            (left, right), (low, high) = (1e3 * np.array(ends) for ends in extent_m)
            axes.add_patch(Rectangle((left, low), right - left, high - low, fill=False, ec=MUTED))
        drawn = axes.scatter(x_mm, y_mm, c=percent, s=90, cmap="Blues", vmin=0.0, ec=MEASURED,
                             lw=0.7, zorder=2, gid="places")  # fmt: skip
        axes.scatter(x_mm[worst], y_mm[worst], s=230, fc="none", ec=PREDICTED, lw=1.8, zorder=3,
                     gid="worst-place")  # fmt: skip
        labelled = range(len(errors)) if len(errors) <= _MOST_LABELLED else [worst]
        for k in labelled:
            text = f"worst, {percent[k]:.2g} %" if k == worst else f"{percent[k]:.2g}"
            axes.annotate(text, (x_mm[k], y_mm[k]), (0, -10), textcoords="offset points",
                          ha="center", va="top", fontsize=7,
                          color=PREDICTED if k == worst else MEASURED)  # fmt: skip
        axes.set(xlabel="x, mm", ylabel="y, mm", aspect="equal")
        axes.margins(0.14)
        figure.colorbar(drawn, ax=axes, label="RMSE, % of the place's peak", shrink=0.8)
        return svg_text(figure)
