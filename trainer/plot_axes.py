"""Axes of matplotlib that a result is drawn on."""

from typing import TYPE_CHECKING

from springpot.codegen.errors import UsageError

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def axes_for_plot(axes: "Axes | None") -> "Axes":
    """Return these axes, or those of a new figure of pyplot where none are given.

    Raises UsageError where matplotlib is not installed.
    """
    if axes is not None:
        return axes
    try:
        from matplotlib import pyplot
    except ModuleNotFoundError:
        raise UsageError(".plot() needs matplotlib: pip install 'springpot[report]'") from None
    return pyplot.subplots(layout="constrained")[1]
