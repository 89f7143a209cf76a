"""The reference's sequential half after the model: coupling, smoothing, and what leaves."""

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.coupling.gains import CoupleConfig
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.followed import Followed
from springpot.codegen.reference.guarding import Guarded
from springpot.codegen.reference.notes import RESYNC, Notes
from springpot.codegen.reference.output import Output
from springpot.codegen.stages.model_force import RangeConfig
from springpot.codegen.stages.stage import bounded, flushed
from springpot.codegen.types import Scalar


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
        self._output = Output(plan)
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
                force_n[i], notes[i] = self._output.hold(latched, guarded.fall[i], guarded.share[i])
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
            force_n[i], note = self._output.force(latched, bool(ticks > 1), force)
            notes[i] |= note
        return force_n

    def _shape(self, x: Scalar, v: Scalar, force: Scalar) -> Scalar:
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
        self.proxy: tuple[Scalar, Scalar] | None = None

    def place(self, x: Scalar, v: Scalar) -> Scalar:
        """Position of the proxy, m, which exists from here on."""
        self.proxy = self.proxy or (x, v)
        return self.proxy[0]

    def force(self, x: Scalar, v: Scalar, model_n: Scalar) -> Scalar:
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
