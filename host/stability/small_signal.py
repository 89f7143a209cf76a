"""Small-signal maps through the real C: a sine on a hold, and the energy that comes back."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.messages import short_repr, with_progress
from springpot.codegen.plan import Plan
from springpot.host.native.scene_library import SceneLibrary
from springpot.trainer.selection.small_signal import (
    DEPTH_FRACTIONS,
    MIN_SIN_DELTA,
    SmallMotion,
    scale_frequencies_hz,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OUTSIDE_SHARES = (1.05, 1.15, 1.3)


@dataclass(frozen=True, eq=False)
class SmallSignalMap:
    """sin(delta) of each cell, the lower one of the two amplitudes; shape (depths, frequencies).

    share: depths of the rows, of the trained one. frequency_hz: of the columns.
    """

    share: Samples
    frequency_hz: Samples
    sin_delta: Samples
    __repr__ = short_repr

    def active(self, outside: bool) -> tuple[int, int]:
        """Cells that give energy, and all cells, inside or outside the trained depth."""
        rows = (self.share > 1.0) == outside
        cells = self.sin_delta[rows]
        return int(np.sum(cells < MIN_SIN_DELTA)), cells.size

    def draw(self, axes: "Axes") -> None:
        """Draw sin(delta) of every cell on matplotlib's axes; cells that give energy are bold."""
        most = max(0.05, float(np.abs(self.sin_delta).max()))
        image = axes.imshow(self.sin_delta, cmap="RdBu", vmin=-most, vmax=most, aspect="auto")
        for (row, column), value in np.ndenumerate(self.sin_delta):
            axes.text(column, row, f"{value:.2f}", ha="center", va="center", fontsize=7,
                      fontweight="bold" if value < MIN_SIN_DELTA else "normal",
                      color="white" if abs(value) > 0.6 * most else "black")  # fmt: skip
        axes.set_xticks(range(len(self.frequency_hz)), [f"{f:.3g}" for f in self.frequency_hz])
        axes.set_yticks(range(len(self.share)), [f"{100 * s:.0f} %" for s in self.share])
        axes.axhline(float(np.sum(self.share <= 1.0)) - 0.5, color="black", lw=1.2)
        axes.set(xlabel="frequency, Hz", ylabel="share of the trained depth")
        axes.figure.colorbar(image, ax=axes, label="sin δ: below 0 gives energy", shrink=0.9)

    def as_dict(self) -> dict[str, int | float]:
        """Return keys of `stability --json`: how many small motions give energy."""
        inside, outside = self.active(False), self.active(True)
        return {
            "active_cells": inside[0],
            "cells": inside[1],
            "active_cells_outside": outside[0],
            "cells_outside": outside[1],
            "worst_sin_delta": float(self.sin_delta.min()),
        }


def small_signal_map(plan: Plan, library: SceneLibrary, delay_samples: int) -> SmallSignalMap:
    """Map of a built scene in open loop; its force is taken delay_samples late."""
    trained, dt_s = plan.range, plan.dt_s
    base_m = 0.0 if plan.contact else float(trained.min_m)
    span_m = float(trained.max_m) - base_m
    frequencies_hz = scale_frequencies_hz(dt_s)
    shares = np.array(DEPTH_FRACTIONS + OUTSIDE_SHARES)
    energies = np.empty((len(shares), len(frequencies_hz)))
    for j, frequency_hz in enumerate(with_progress(frequencies_hz.tolist(), "small motions")):
        small = SmallMotion(frequency_hz, dt_s, delay_samples)
        for i, share in enumerate(shares):
            energies[i, j] = small.min_sin_delta(
                lambda *motion: library.new_state().run(*motion)[0], base_m + share * span_m, span_m
            )
    return SmallSignalMap(shares, frequencies_hz, energies)
