"""Stages of past samples: taps (sp_taps.h), positions (sp_lags.h), velocities (sp_velocity.h).

And the tool's velocity, for a coupling (sp_tool_velocity.h).
"""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.literals import array_text, constant_text
from springpot.codegen.model.features import FirBank, Lags, PositionVelocity
from springpot.codegen.model.formulas import estimate_foaw_velocity
from springpot.codegen.stages.stage import (
    REAL,
    U32,
    Columns,
    FeatureStage,
    Member,
    Probe,
    SceneTicks,
    Stage,
    Starts,
    feature_stage,
    pad_history,
    round_up,
    smooth_average,
    stage_code,
    window_members,
)
from springpot.codegen.types import RealType, Scalar

N_PARTIAL_SUMS = 16  # SP_TAPS_LANES
LOWPASS_TAU_S = 0.004  # of the low-pass


@dataclass(frozen=True, eq=False)
class FirStage(FeatureStage):
    """orders: those used. taps: shape (orders, length), zero beyond `n_taps`."""

    orders: tuple[float, ...]
    taps: Reals
    n_taps: int

    headers = ("sp_window.h", "sp_taps.h")

    code = stage_code("fir")

    @property
    def n_features(self) -> int:
        return len(self.orders)

    @property
    def capacity(self) -> int:
        return len(self.taps)

    @property
    def members(self) -> tuple[Member, ...]:
        return window_members("history", "newest", self.taps.shape[1])

    def tables(self) -> list[str]:
        """Render the C table of the window's weights, for each derivative."""
        names = ", ".join(f"{order:g}" for order in self.orders)
        rows, length = self.taps.shape
        return [
            f"enum {{\n    N_TAPS = {length},\n    N_ORDERS = {rows}\n}};",
            f"/* c(r, k), newest first, {self.n_taps} and padding: a row each of {names}. */",
            array_text("taps", "sp_real", self.taps),
        ]

    def probe(self) -> Probe:
        rows, length = self.taps.shape
        return Probe(
            inputs=length,
            outputs=rows,
            sums=lambda made_up: np.array([sum_taps(row, made_up, 1)[0] for row in self.taps]),
        )

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """Return the derivatives along a depth, (n, features), as the C computes them."""
        length = self.taps.shape[1]
        result = np.zeros((len(depth), self.n_features), dtype=depth.dtype)
        for rows, samples in pad_history(depth, starts, length - 1):
            n = len(samples) - length + 1
            newest_first = samples[::-1]
            for i in range(self.n_features):
                result[rows, i] = sum_taps(self.taps[i], newest_first, n)[::-1]
        return result


def sum_taps(taps: Reals, newest_first: Reals, n: int) -> Reals:
    """sp_taps.h for n windows, the newest first, each a sample earlier: shape (n,), m/s^r."""
    windows = sliding_window_view(np.ascontiguousarray(newest_first), n)
    s = np.zeros((N_PARTIAL_SUMS, n), dtype=taps.dtype)
    for k in range(0, len(taps), N_PARTIAL_SUMS):
        s += taps[k : k + N_PARTIAL_SUMS, None] * windows[k : k + N_PARTIAL_SUMS]
    s = s[:8] + s[8:]
    s = s[:4] + s[4:]
    total: Reals = (s[0] + s[2]) + (s[1] + s[3])
    return total


@feature_stage.register
def fir_stage(bank: FirBank, used: Columns, dt_s: float, dtype: RealType) -> FirStage:
    """Keep the columns `used` of the bank."""
    n_taps = len(bank.taps)
    taps: Reals = np.zeros((max(len(used), 1), round_up(n_taps, N_PARTIAL_SUMS)), dtype=dtype)
    taps[: len(used), :n_taps] = bank.taps[:, used].T
    return FirStage(orders=tuple(bank.orders[i] for i in used), taps=taps, n_taps=n_taps)


@dataclass(frozen=True, eq=False)
class LagsStage(FeatureStage):
    """lags: those used, in samples."""

    lags: NDArray[np.uint32]

    headers = ("sp_lags.h",)

    code = stage_code("lags")

    @property
    def n_features(self) -> int:
        return len(self.lags)

    @property
    def _length(self) -> int:
        return int(self.lags.max()) + 1

    @property
    def members(self) -> tuple[Member, ...]:
        return (
            Member(f"sp_real past[{self._length}]", (REAL,) * self._length),
            Member("uint32_t newest", (U32,)),
        )

    def tables(self) -> list[str]:
        return [
            f"enum {{\n    N_PAST = {self._length},\n    N_LAGS = {len(self.lags)}\n}};",
            array_text("lags", "uint32_t", self.lags),
        ]

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """Return past positions as features, (n, lags), m."""
        longest = self._length - 1
        result = np.zeros((len(depth), self.n_features), dtype=depth.dtype)
        for rows, samples in pad_history(depth, starts, longest):
            n = len(samples) - longest
            for i, lag in enumerate(self.lags.tolist()):
                result[rows, i] = samples[longest - lag : longest - lag + n]
        return result


@feature_stage.register
def lags_stage(lags: Lags, used: Columns, dt_s: float, dtype: RealType) -> LagsStage:
    """Keep the lags `used`."""
    chosen = np.array([lags.samples[i] for i in used] or [0], dtype=np.uint32)
    return LagsStage(chosen)


@dataclass(frozen=True, eq=False)
class PositionVelocityStage(FeatureStage):
    """Features: depth, velocity of the depth. per_step: shape (length,), 1/s.

    weight: of the newest velocity in its moving average; None: there is none.
    """

    per_step: Reals
    band_m: Real
    weight: Real | None

    n_features = 2

    code = stage_code("position_velocity")

    @property
    def headers(self) -> tuple[str, ...]:
        return "sp_window.h", "sp_velocity.h", *(() if self.weight is None else ("sp_smooth.h",))

    @property
    def members(self) -> tuple[Member, ...]:
        window = window_members("clipped_track", "clipped_newest", len(self.per_step) + 1)
        return window if self.weight is None else (*window, Member("sp_real clipped_mps", (REAL,)))

    def tables(self) -> list[str]:
        """Render the C tables: 1/time of each window of the velocity, and its noise band."""
        weight = [] if self.weight is None else [constant_text("clipped_weight", self.weight)]
        return [
            f"enum {{\n    N_CLIPPED_STEPS = {len(self.per_step)}\n}};",
            array_text("clipped_per_step", "sp_real", self.per_step),
            constant_text("clipped_band_m", self.band_m),
            *weight,
        ]

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """Return position and estimated velocity, (n, 2), by the operations of the C."""
        length = len(self.per_step)
        velocity = np.zeros_like(depth)
        for rows, samples in pad_history(depth, starts, length):
            windows = sliding_window_view(samples, length + 1)
            velocity[rows] = estimate_foaw_velocity(self.per_step, self.band_m, windows)
            if self.weight is not None:
                average = velocity.dtype.type(0)
                for i in range(rows.start, rows.stop):
                    velocity[i] = average = smooth_average(self.weight, average, velocity[i])
        return np.stack([depth, velocity], axis=1)


@feature_stage.register
def position_velocity_stage(
    features: PositionVelocity, used: Columns, dt_s: float, dtype: RealType
) -> PositionVelocityStage:
    """Depth and its velocity, whichever of them are `used`."""
    per_step = [1.0 / (j * dt_s) for j in range(1, features.length + 1)]
    weight = None if features.weight == 1.0 else dtype(features.weight)
    return PositionVelocityStage(np.array(per_step, dtype=dtype), dtype(features.band_m), weight)


@dataclass(frozen=True)
class ToolVelocityStage(Stage):
    """Follows the guarded position; its value is the C variable `position_mps`."""

    rate_hz: Real
    weight: Real
    lag: Real  # twice the lag of the velocity, ticks: of the low-pass, and half a tick

    headers = ("sp_tool_velocity.h",)
    members = (Member("sp_tool_velocity_state tool_velocity", (REAL, REAL)),)

    code = stage_code("tool_velocity")

    def tables(self) -> list[str]:
        return [
            constant_text("rate_hz", self.rate_hz),
            constant_text("velocity_weight", self.weight),
            constant_text("velocity_lag", self.lag),  # used by make_up of scene.c.j2
        ]

    def next(self, velocity_mps: Scalar, before_m: Scalar, x: Scalar) -> Scalar:
        """sp_tool_velocity: the velocity at x, m/s, a tick after before_m."""
        return smooth_average(self.weight, velocity_mps, (x - before_m) * self.rate_hz)


def build_tool_velocity_stage(ticks: SceneTicks) -> ToolVelocityStage:
    """Difference at 1/dt_s, low-passed over TIME_S by backward Euler."""
    dt_s, dtype = ticks.dt_s, ticks.dtype
    return ToolVelocityStage(
        rate_hz=dtype(1.0 / dt_s),
        weight=dtype(dt_s / (dt_s + LOWPASS_TAU_S)),
        lag=dtype(2.0 * LOWPASS_TAU_S / dt_s + 1.0),
    )
