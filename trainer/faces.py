"""What a notebook shows of a result, and `.plot()`: drawn above, by the part "faces"."""

from typing import TYPE_CHECKING, Any

from springpot.codegen.entry_points import part, required_part

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Faces:
    """A result with a table and a picture."""

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw this on matplotlib's axes, on new ones if none are given; return them.

        Raises UsageError that says what to install where matplotlib is missing.
        """
        axes: Axes = required_part("faces", ".plot()").plotted(self, ax)
        return axes

    def _repr_html_(self) -> str | None:
        """Table of the command line and, where matplotlib is installed, a small picture."""
        faces: Any = part("faces")
        return None if faces is None else str(faces.html(self))
