"""The reference's sequential halves: the guard before the model, and all that follows it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.coupling.gains import CoupleConfig
from springpot.codegen.plan.limits import GuardConfig, OutputConfig
from springpot.codegen.plan.plan import Plan
from springpot.codegen.stages.model_force import RangeConfig
from springpot.codegen.stages.stage import SMALLEST, flushed

# Bits of sp_notes.h; a test compares them with the header.
HELD, RESYNC, OUTSIDE, CLAMPED, RAMPED, LATCHED, LIMITED = 1, 2, 4, 8, 16, 32, 64

Notes = NDArray[np.int32]


class Guarding:
    """sp_guard.h, over a run from a fresh state."""

    def __init__(self, config: GuardConfig) -> None:
        self._config = config

    def run(self, raw: Reals) -> tuple[Reals, Notes]:
        """Positions that the tick may believe, (n,), m, and HELD or RESYNC for each, (n,)."""
        jump_m = self._config.jump_m
        real = raw.dtype.type
        raw = np.where(np.abs(raw) < real(SMALLEST), real(0), raw)
        position = raw.copy()
        notes = np.zeros(len(raw), dtype=np.int32)
        good = suspect = raw.dtype.type(0)
        agreeing = 0
        started = False
        plausible = (raw >= self._config.min_m) & (raw <= self._config.max_m)
        for i, x in enumerate(raw):
            if not plausible[i]:
                agreeing = 0
                notes[i] = HELD
            elif not started:
                started = True
                good = x
                notes[i] = RESYNC
            elif abs(x - good) <= jump_m:
                agreeing = 0
                good = x
            else:
                agreeing = agreeing + 1 if agreeing and abs(x - suspect) <= jump_m else 1
                suspect = x
                notes[i] = HELD
                if agreeing >= self._config.resync_ticks:
                    agreeing = 0
                    good = x
                    notes[i] = RESYNC
            position[i] = good
        return position, notes


def shaped(plan: Plan, pressed: Reals, model_n: Reals) -> Reals:
    """sp_range_fade and sp_contact.h: the model's force at border and surface, (n,), N."""
    zero, one = model_n.dtype.type(0), model_n.dtype.type(1)
    if plan.per_fade is not None:
        beyond = _beyond(plan.range, pressed)
        share = one - beyond * plan.per_fade
        fading = np.where(share > 0, model_n * share, zero)
        model_n = np.where(beyond > 0, fading, model_n)
    if plan.per_onset is not None:
        share = pressed * plan.per_onset
        rising = np.where(share < 1, model_n * share, model_n)
        model_n = np.where(share > 0, rising, zero)
    return model_n


def _beyond(config: RangeConfig, x: Reals) -> Reals:
    above, below = x - config.max_m, config.min_m - x
    return np.where(above > below, above, below)


class OutputStage:
    """Contact, coupling, smoothing and output: sp_contact.h to sp_output.h."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._couple = Coupled(plan.couple) if plan.couple is not None else None
        self._output = _Output(plan.output)
        self._smoothed = plan.dtype(0)

    def run(
        self,
        position: Reals,
        velocity: Reals,
        pressed: Reals,
        model_n: Reals,
        contact: NDArray[np.bool_],
        held: NDArray[np.bool_],
        notes: Notes,
    ) -> Reals:
        """Force of each tick, (n,), N; adds its notes to `notes`.

        position, velocity: of the tool, m, m/s. pressed: where the model looks, m. All are (n,).
        """
        model_n = shaped(self._plan, pressed, model_n)
        force_n = np.zeros_like(model_n)
        for i in range(len(position)):
            self._output.watch(held[i])
            if notes[i] & RESYNC:
                self._forget()
                self._output.restart()
            force = model_n.dtype.type(0)
            if contact[i]:
                force = self._shape(position[i], velocity[i], model_n[i])
            else:
                self._forget()
                self._output.free()
            force_n[i], note = self._output.force(force)
            notes[i] |= note
        return force_n

    def _shape(self, x: Any, v: Any, force: Any) -> Any:
        if self._couple is not None:
            force = self._couple.force(x, v, force)
        if self._plan.smooth_alpha is not None:
            alpha, held = self._plan.smooth_alpha, self._smoothed
            self._smoothed = flushed(held + alpha * (force - held))
            force = self._smoothed
        return force

    def _forget(self) -> None:
        if self._couple is not None:
            self._couple.proxy = None
        self._smoothed = self._plan.dtype(0)


class Coupled:
    """sp_couple.h: Algorithm 1, stepped exactly."""

    def __init__(self, config: CoupleConfig) -> None:
        self._config = config
        self.proxy: tuple[Any, Any] | None = None

    def place(self, x: Any, v: Any) -> Any:
        """Position of the proxy, m, which exists from here on."""
        self.proxy = self.proxy or (x, v)
        return self.proxy[0]

    def force(self, x: Any, v: Any, model_n: Any) -> Any:
        """Force at the tool, N; then moves the proxy."""
        config = self._config
        self.place(x, v)
        assert self.proxy is not None
        proxy_m, proxy_mps = self.proxy
        e = proxy_m - x
        w = proxy_mps - v
        force_n = -(config.stiffness_npm * e) - config.damping_nspm * w
        rest = -(config.compliance_mpn * model_n)
        from_rest = e - rest
        phi = config.phi
        self.proxy = (
            x + config.dt_s * v + (rest + (phi[0] * from_rest + phi[1] * w)),
            v + (phi[2] * from_rest + phi[3] * w),
        )
        return force_n


class _Output:
    def __init__(self, config: OutputConfig) -> None:
        self._config = config
        self._real = type(config.dt_s)
        self._force: Any = self._real(0)
        self._share: Any = self._real(0)
        self._silent: Any = self._real(0)
        self._latched = False

    def restart(self) -> None:
        self._share = self._real(0)

    def free(self) -> None:
        self._share = self._real(1)
        self._force = self._real(0)

    def watch(self, held: bool) -> None:
        self._silent = self._silent + self._config.dt_s if held else self._real(0)
        if self._silent > self._config.watchdog_s:
            self._latched = True

    def force(self, force: Any) -> tuple[Any, int]:
        if self._latched:
            return self._fall(), LATCHED
        note = 0
        if self._share < 1:
            force = force * self._share
            self._share = self._share + self._config.rise
            note |= RAMPED
        force, limited = self._slewed(force)
        note |= limited
        min_n, max_n = self._config.min_n, self._config.max_n
        if not min_n <= force <= max_n:
            clamped = min_n if force < min_n else self._real(0)
            force = max_n if force > max_n else clamped
            note |= CLAMPED
        self._force = force
        return force, note

    def _slewed(self, force: Any) -> tuple[Any, int]:
        zero, last = self._real(0), self._force
        most = (last if last > 0 else zero) + self._config.slew_n
        minimum = (last if last < 0 else zero) - self._config.slew_n
        if force > most:
            return most, LIMITED
        return (minimum, LIMITED) if force < minimum else (force, 0)

    def _fall(self) -> Any:
        size = abs(self._force)
        step = self._config.fall_nps * self._config.dt_s
        left = size - step if size > step else self._real(0)
        self._force = -left if self._force < 0 else left
        return self._force
