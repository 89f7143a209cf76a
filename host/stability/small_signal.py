"""Small-signal maps through the real C: a sine on a hold, and the energy that comes back."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.plan.plan import Plan
from springpot.host.native.scene_library import SceneLibrary

INSIDE = (0.2, 0.35, 0.5, 0.65, 0.8)  # of the trained depth
OUTSIDE_SHARES = (1.05, 1.15, 1.3)
AMPLITUDES = (0.01, 0.05)
ACTIVE = -0.005  # a cell below this sin(delta) gives energy to the hand
_FREQUENCIES_HZ = np.geomspace(2.0, 80.0, 6)  # at 1 kHz and above
_MEASURED_S, _SETTLE_S = 0.25, 0.2


@dataclass(frozen=True, eq=False)
class Map:
    """sin(delta) of each cell, the lower one of the two amplitudes; shape (depths, frequencies).

    share: depths of the rows, of the trained one. frequency_hz: of the columns.
    """

    share: NDArray[np.float64]
    frequency_hz: NDArray[np.float64]
    sin_delta: NDArray[np.float64]

    def active(self, outside: bool) -> tuple[int, int]:
        """Cells that give energy, and all cells, inside or outside the trained depth."""
        rows = (self.share > 1.0) == outside
        cells = self.sin_delta[rows]
        return int(np.sum(cells < ACTIVE)), cells.size

    def as_dict(self) -> dict[str, int | float]:
        inside, outside = self.active(False), self.active(True)
        return {
            "active_cells": inside[0],
            "cells": inside[1],
            "active_cells_outside": outside[0],
            "cells_outside": outside[1],
            "worst_sin_delta": float(self.sin_delta.min()),
        }


def small_signal_map(plan: Plan, library: SceneLibrary, delay_samples: int) -> Map:
    """Map of a built scene in open loop; its force is taken delay_samples late."""
    trained, dt_s = plan.range, plan.dt_s
    base_m = 0.0 if plan.contact else float(trained.min_m)
    span_m = float(trained.max_m) - base_m
    frequencies = _FREQUENCIES_HZ * min(1.0, 1e-3 / dt_s)
    shares = np.array(INSIDE + OUTSIDE_SHARES)
    found = np.empty((len(shares), len(frequencies)))
    for i, share in enumerate(shares):
        for j, frequency_hz in enumerate(frequencies):
            found[i, j] = min(
                _sin_delta(library, base_m + share * span_m, amplitude * span_m,
                           float(frequency_hz), dt_s, delay_samples)
                for amplitude in AMPLITUDES
            )  # fmt: skip
    return Map(shares, frequencies, found)


def _sin_delta(
    library: SceneLibrary, at_m: float, amplitude_m: float, frequency_hz: float, dt_s: float,
    delay_samples: int,
) -> float:  # fmt: skip
    """Loss part of the force's fundamental, of its size; 0 where the force does not change."""
    slower = max(1.0, dt_s / 1e-3)
    cycles = max(1, round(_MEASURED_S * slower * frequency_hz))
    period_ticks = round(cycles / (frequency_hz * dt_s))
    turn = 2.0 * np.pi * cycles / period_ticks
    settle = round(_SETTLE_S * slower / dt_s) + period_ticks // cycles
    ticks = np.arange(settle + period_ticks + delay_samples)
    velocity = amplitude_m * turn / dt_s * np.cos(turn * ticks)
    force_n, _ = library.new_state().run(at_m + amplitude_m * np.sin(turn * ticks), velocity)
    measured = force_n[settle : settle + period_ticks].astype(np.float64)
    phase = turn * (ticks[settle : settle + period_ticks] + delay_samples)
    stored, lost = np.mean(measured * np.sin(phase)), np.mean(measured * np.cos(phase))
    size_n = float(np.hypot(stored, lost))
    if np.ptp(measured) == 0.0 or size_n == 0.0:
        return 0.0
    return float(lost / size_n)
