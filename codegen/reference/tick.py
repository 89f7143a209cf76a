"""The reference's sequential half after the model: coupling, smoothing, and what leaves."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.coupling.gains import CoupleConfig
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.followed import Followed
from springpot.codegen.reference.guarding import Guarded
from springpot.codegen.reference.notes import CLAMPED, HELD, LATCHED, LIMITED, RAMPED, RESYNC, Notes
from springpot.codegen.stages.model_force import RangeConfig
from springpot.codegen.stages.stage import bounded, flushed

PACE, HURRY, DECAY = 1.2, 1.03, 0.9  # SP_OUTPUT_PACE, SP_OUTPUT_HURRY, SP_OUTPUT_DECAY


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
        self._output = _Output(plan)
        self._smoothed = plan.dtype(0)

    def run(
        self, guarded: Guarded, followed: Followed, pressed: Reals, model_n: Reals,
        contact: NDArray[np.bool_], notes: Notes,
    ) -> Reals:  # fmt: skip
        """Force of each tick, (n,), N; adds its notes to `notes`, (n,).

        Of the rows of `followed`, (rows,): pressed, where the model looks, m, the model's force,
        N, and whether there is contact.
        """
        model_n = shaped(self._plan, pressed, model_n)
        force_n = np.zeros(len(notes), dtype=model_n.dtype)
        for i, (ticks, latched) in enumerate(zip(guarded.ticks, guarded.latched, strict=True)):
            if not ticks:
                held_n, note = self._output.hold(latched, guarded.fall[i])
                force_n[i], notes[i] = guarded.share[i] * held_n, note
                continue
            row = followed.row[i]
            if notes[i] & RESYNC:
                self._forget()
                self._output.restart()
            for at in range(row - ticks + 1, row + 1):
                force = model_n.dtype.type(0)
                if contact[at]:
                    force = self._shape(followed.position[at], followed.velocity[at], model_n[at])
                else:
                    self._forget()
                    self._output.free()
            force_n[i], note = self._output.force(latched, model_n.dtype.type(ticks), force)
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
            bounded(x + config.dt_s * v + (rest + (phi[0] * from_rest + phi[1] * w))),
            bounded(v + (phi[2] * from_rest + phi[3] * w)),
        )
        return force_n


class _Output:
    def __init__(self, plan: Plan) -> None:
        self._config = plan.output
        self._real = plan.dtype
        # One tick in ticks, as the C has it: 1 but for rounding.
        self._tick = plan.silence.dt_s * plan.silence.per_dt
        self._force: Any = self._real(0)
        self._share: Any = self._real(0)
        self._model: Any = self._real(0)
        self._slope: Any = self._real(0)
        self._aim: Any = self._real(0)
        self._pace: Any = self._real(0)

    def restart(self) -> None:
        self._share = self._slope = self._pace = self._real(0)

    def free(self) -> None:
        self._share = self._real(1)
        self._force = self._model = self._slope = self._pace = self._real(0)

    def hold(self, latched: Any, fall: Any) -> tuple[Any, int]:
        """A tick without a good sample; fall: how much of it was latched."""
        if self._tick - fall >= 0.5:
            self._wait()
        if latched:
            return self._fall(fall), LATCHED
        return self._force, HELD

    def _wait(self) -> None:
        under_way = self._pace > 0
        at = self._clamped((self._aim if under_way else self._force) + self._slope)[0]
        self._slope = flushed(self._real(DECAY) * self._slope)
        if under_way:
            self._aim = at
            self._return()
        else:
            self._force = at

    def force(self, latched: Any, ticks: Any, force: Any) -> tuple[Any, int]:
        """A good sample, `ticks` after the last one."""
        if latched:
            return self._fall(self._real(1)), LATCHED
        last, note = self._force, 0
        if self._share < 1:
            force = force * self._share
            self._share = self._share + self._config.rise * ticks
            note |= RAMPED
        late = self._pace > 0 or ticks > self._real(PACE)
        if late:
            force, clamped = self._after_silence(ticks, force)
            note |= clamped
        force, limited = self._slewed(ticks, last, force)
        self._force, clamped = self._clamped(force)
        if not late:
            self._slope = self._force - self._model
            self._model = self._force
        return self._force, note | limited | clamped

    def _after_silence(self, ticks: Any, force: Any) -> tuple[Any, int]:
        before = abs(self._slope)
        self._aim, note = self._clamped(force)
        self._slope = (self._aim - self._model) / ticks
        self._model = self._aim
        change = max(abs(self._slope), before)
        if not ticks > self._real(PACE):
            change = min(change, self._real(HURRY) * self._pace)
        self._pace = max(change, self._pace)
        self._return()
        return self._force, note | (LIMITED if self._pace > 0 else 0)

    def _return(self) -> None:
        may = self._real(PACE) * self._pace + self._config.return_n
        up, down = self._force + may, self._force - may
        if self._aim > up:
            self._force = up
        elif self._aim < down:
            self._force = down
        else:
            self._force, self._pace = self._aim, self._real(0)

    def _clamped(self, force: Any) -> tuple[Any, int]:
        min_n, max_n = self._config.min_n, self._config.max_n
        if min_n <= force <= max_n:
            return force, 0
        beyond = min_n if force < min_n else self._real(0)
        return (max_n if force > max_n else beyond), CLAMPED

    def _slewed(self, ticks: Any, last: Any, force: Any) -> tuple[Any, int]:
        zero, slew = self._real(0), self._config.slew_n * ticks
        most = (last if last > 0 else zero) + slew
        minimum = (last if last < 0 else zero) - slew
        if force > most:
            return most, LIMITED
        return (minimum, LIMITED) if force < minimum else (force, 0)

    def _fall(self, ticks: Any) -> Any:
        step = self._config.fall_n * ticks
        down, up = self._force - step, self._force + step
        self._force = down if down > 0 else up if up < 0 else self._real(0)
        return self._force
