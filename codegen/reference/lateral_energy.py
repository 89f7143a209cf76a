"""The reference of sp_energy3.h: the account of energy along the direction of the force."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from springpot.codegen.plan.energy import EnergyConfig
from springpot.codegen.reference.output import Account
from springpot.codegen.stages.stage import bounded, flushed

_SIGNS = (-1.0, -1.0, 1.0)  # of the ways that a force works against: x, y, depth


class Account3(Account):
    """sp_energy3.h; positions, ways and steps are x, y and depth, m.

    unit: the direction of the force, which the loop keeps up to date.
    """

    def __init__(self, config: EnergyConfig, real: type[Any]) -> None:
        self.unit: list[Any] = [real(0)] * 3
        self._config, self._real = config, real
        self._along = Account(config, real)
        self.restart([real(0)] * 3)

    def restart(self, x: Any) -> None:
        """Begin at x as if nothing had been pressed."""
        self._along.restart(x[2])
        self._paid, self._looked = list(x), list(x)
        self._steps, self._bends = [self._real(0)] * 3, [self._real(0)] * 3

    def pay(self, given: Any, x: Any, ticks: Any, damped: Any) -> None:
        """A good sample at x, so many ticks after the last one, under the force given, N."""
        zero = self._real(0)
        moved = [at - was for at, was in zip(x, self._paid, strict=True)]
        moved = [way if abs(way) > self._config.slack_m else zero for way in moved]
        self._paid = [at if way else was for at, was, way in zip(x, self._paid, moved, strict=True)]
        left = (self._along.left + damped) + given * self._against(moved)
        self._along.left = bounded(min(left, self._along.most(x[2])))
        self._along.ticks = self._along.ticks + ticks
        if self._along.ticks >= self._config.look_ticks:
            self._look(x)

    def limit(self, step: Any, force: Any) -> tuple[Any, int]:
        """The force that the account can pay for if the tool goes on by step; notes."""
        return self._along.limit(self._against(step), force)

    def wait(self, silent: Any, ticks: Any, given: Any) -> tuple[Any, int]:
        """Ticks without a good sample: the force that is left along its direction; notes."""
        along = self._along
        along.step, along.bend = self._against(self._steps), self._against(self._bends)
        along.position = self._paid[2]
        given, note = along.wait(silent, ticks, given)
        on = along.position - self._paid[2]
        self._paid = [
            bounded(was + self._real(sign) * (part * on))
            for was, sign, part in zip(self._paid, _SIGNS, self.unit, strict=True)
        ]
        return given, note

    def _against(self, way: Sequence[Any]) -> Any:
        """sp_energy3_way."""
        unit = self.unit
        return unit[2] * way[2] - (unit[0] * way[0] + unit[1] * way[1])

    def _look(self, x: Sequence[Any]) -> None:
        along, real = self._along, self._real
        per_tick = real(1) / along.ticks
        for k, at in enumerate(x):
            way = at - self._looked[k]
            step = (way if abs(way) > self._config.slack_m else real(0)) * per_tick
            self._bends[k] = (step - self._steps[k]) * per_tick
            self._steps[k] = step
        bent = np.sqrt(squared(self._bends, real))
        turn = flushed(along.turn * self._config.keep)
        along.turn = bent if bent > turn else turn
        self._looked, along.ticks = list(x), real(0)


def squared(way: Sequence[Any], real: type[Any]) -> Any:
    """sp_energy3_square, m^2."""
    total = real(0)
    for part in way:
        total = total + abs(part) * abs(part)
    return total
