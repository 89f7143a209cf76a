"""Limits of a scene: positions that are believed, forces that leave, when the watchdog falls."""

from dataclasses import dataclass

from springpot.codegen.arrays import Real
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Scene
from springpot.codegen.stages.stage import SceneTicks

# Guard: a hand does not move faster than this, and never faster than 8 x what was trained; less
# than a millimetre is noise: at 8 kHz, five steps of an encoder of 50 um once latched a still hand.
MIN_JUMP_MPS = 1.0
MIN_JUMP_M = 1e-3
JUMP_PER_TRAINED_SPEED = 8.0
_MAX_HEIGHT_M = 10.0  # a tool may wait this far from the surface
MIN_PLAUSIBLE_M = 0.1
PLAUSIBLE_PER_RANGE = 10.0
RESYNC_TICKS = (2, 5)  # before the watchdog latches, at most five
MIN_WATCHDOG_TICKS = 3
RAMP_S = 0.05
LATCH_FALL_S = 0.008  # from the maximum force; 10 ms with the ticks' rounding
FORCE_MARGIN = 1.2
# Maximum growth of the force: never under 1.5 N/ms (slower destabilises), and the clamp in 4 ms.
# In a shorter tick that of a millisecond: an encoder's noise is not less in it.
MIN_SLEW_NPS = 1500.0
SLEW_S = 0.004
SLEW_TICK_S = 0.001


@dataclass(frozen=True)
class GuardConfig:
    """sp_guard_config of sp_guard.h, member by member: which positions are plausible."""

    max_step_m: Real
    min_m: Real
    max_m: Real
    air_m: Real
    resync_ticks: int


@dataclass(frozen=True)
class OutputConfig:
    """sp_output_config of sp_output.h, member by member: limits of the force."""

    min_n: Real
    max_n: Real
    slew_n: Real
    ramp_per_tick: Real
    latch_fall_n: Real


@dataclass(frozen=True)
class SilenceConfig:
    """sp_silence_config of sp_silence.h, member by member: how long samples may stay away."""

    dt_s: Real
    rate_hz: Real
    watchdog_s: Real


def watchdog_timeout_s(scene: Scene, dt_s: float) -> float:
    """Time without a good sample after which the force falls to zero, s.

    Raises UsageError where one bad sample would do.
    """
    watchdog_s = 1e-3 * (scene.guard.watchdog_ms or max(20.0, 3e3 * dt_s))
    if watchdog_s < (MIN_WATCHDOG_TICKS - 0.5) * dt_s:
        raise UsageError(
            f"guard.watchdog_ms = {1e3 * watchdog_s:g}: at {1 / dt_s:g} Hz give at least "
            f"{1e3 * MIN_WATCHDOG_TICKS * dt_s:g}, or one bad sample latches"
        )
    return watchdog_s


def build_guard_config(
    model: Model, watchdog_s: float, ticks: SceneTicks, coupled: bool
) -> GuardConfig:
    """Build limits of plausible positions: ten trained depths, steps of at most a hand's speed.

    A tool may also wait far above a surface, and fly there as fast as it likes: nothing is
    touched. Not so behind a coupling, whose damper would carry that speed into the next touch.
    """
    dt_s, real, trained = ticks.dt_s, ticks.dtype, model.trained
    deepest_m = max(abs(trained.min_m), abs(trained.max_m))
    plausible_m = max(MIN_PLAUSIBLE_M, PLAUSIBLE_PER_RANGE * deepest_m)
    before_latch = int(watchdog_s / dt_s) - 1
    return GuardConfig(
        max_step_m=real(max(MIN_JUMP_M, dt_s * compute_max_mps(model))),
        min_m=real(-_MAX_HEIGHT_M if ticks.surface else -plausible_m),
        max_m=real(plausible_m),
        air_m=real(0.0 if ticks.surface and not coupled else -_MAX_HEIGHT_M),
        resync_ticks=min(max(before_latch, RESYNC_TICKS[0]), RESYNC_TICKS[1]),
    )


def compute_max_mps(model: Model) -> float:
    """Maximum believable speed of the hand, m/s."""
    return max(MIN_JUMP_MPS, JUMP_PER_TRAINED_SPEED * model.trained.max_mps)


def build_output_config(model: Model, scene: Scene, ticks: SceneTicks) -> OutputConfig:
    """Return forces that leave. Raises DataError where the model never pushes out."""
    dt_s, contact, real, trained = ticks.dt_s, ticks.surface, ticks.dtype, model.trained
    peak_n = trained.max_n if contact else max(abs(trained.min_n), abs(trained.max_n))
    max_n = scene.guard.max_force_n or FORCE_MARGIN * peak_n
    if max_n <= 0.0:
        raise DataError(
            f"the model's forces never push out (maximum {trained.max_n:g} N): turn the sign "
            "round on import, for example --map force=COL:-1N, and train again"
        )
    min_n = 0.0 if contact else max(-max_n, min(0.0, FORCE_MARGIN * trained.min_n))
    return OutputConfig(
        min_n=real(min_n),
        max_n=real(max_n),
        slew_n=real(max(dt_s, SLEW_TICK_S) * max(MIN_SLEW_NPS, max_n / SLEW_S)),
        ramp_per_tick=real(min(1.0, dt_s / RAMP_S)),
        latch_fall_n=real(dt_s * max_n / LATCH_FALL_S),
    )


def build_silence_config(watchdog_s: float, ticks: SceneTicks) -> SilenceConfig:
    """Build the watchdog; half a tick late, so that rounded sums of ticks agree on it."""
    dt_s, real = ticks.dt_s, ticks.dtype
    return SilenceConfig(
        dt_s=real(dt_s), rate_hz=real(1.0 / dt_s), watchdog_s=real(watchdog_s + 0.5 * dt_s)
    )
