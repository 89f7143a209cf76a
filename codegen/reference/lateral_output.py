"""Reference of a force of three axes as it leaves: sp_energy3.h, and sp_lateral.h with sp_output.h.

The account of energy is along the direction of the force, whose length leaves as one force does.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from springpot.codegen.plan.energy import EnergyConfig
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.notes import LIMITED
from springpot.codegen.reference.output import Account, Output
from springpot.codegen.stages.stage import SMALLEST, bounded, flushed

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
        self._paid, self._looked, self._rest = list(x), list(x), list(x)
        self._steps, self._bends = [self._real(0)] * 3, [self._real(0)] * 3

    @property
    def held(self) -> Any:
        """Force before the last silence, N."""
        return self._along.held

    def pay(self, given: Any, held: Any, x: Any, ticks: Any, step: Any, damped: Any) -> Any:
        """A good sample at x, so many ticks after the last one, under forces held to given, N.

        Returns the step that the tool may go on by.
        """
        zero = self._real(0)
        moved = [at - was for at, was in zip(x, self._paid, strict=True)]
        moved = [way if abs(way) > self._config.slack_m else zero for way in moved]
        self._paid = [at if way else was for at, was, way in zip(x, self._paid, moved, strict=True)]
        against = self._against(moved)
        left = (self._along.left + damped) + min(given * against, held * against)
        self._along.left = bounded(min(left, self._along.most(x[2])))
        self._along.ticks = self._along.ticks + ticks
        if self._along.ticks >= self._config.look_ticks:
            self._look(x)
        found = [self.on(*each) for each in zip(self._rest, x, step, strict=True)]
        self._rest = [rest for rest, _ in found]
        return [on for _, on in found]

    def limit(self, step: Any, force: Any) -> tuple[Any, int]:
        """The force that the account can pay for if the tool goes on by step; notes."""
        return self._along.limit(self._against(step), force)

    def wait(self, silent: Any, ticks: Any, held: Any, given: Any) -> tuple[Any, int]:
        """Ticks without a good sample: the force that is left along its direction; notes."""
        along = self._along
        along.step, along.bend = self._against(self._steps), self._against(self._bends)
        along.position = self._paid[2]
        given, note = along.wait(silent, ticks, held, given)
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


class Output3(Output):
    """A length as Output keeps it, and its direction, of which the account hears."""

    def __init__(self, plan: Plan, account: Account3 | None) -> None:
        super().__init__(plan, account)
        self._along, zero = account, self._real(0)
        self._unit, self._was = [zero] * 3, [zero] * 3

    def turn(self, felt: Sequence[Any]) -> Any:
        """sp_lateral_length."""
        one, parts = self._real(1), [flushed(bounded(n)) for n in felt]
        length = np.sqrt(squared(parts, self._real))
        known = length > self._real(SMALLEST)
        self._unit = [max(min(n / length, one), -one) if known else self._real(0) for n in parts]
        if self._along is not None:
            self._along.unit = self._unit
        return length

    def vector(self, given: Any) -> list[Any]:
        """sp_lateral_give."""
        return [given * part for part in self._unit]

    def came_from(self, before: list[Any], latched: bool) -> None:
        """Know the vector that was given last; latched, keep its direction."""
        self._was = before
        if latched:
            self.turn(before)

    def _slewed(self, force: Any) -> tuple[Any, int]:
        """sp_output_force's end, and sp_lateral_grown."""
        given, note = super()._slewed(force)
        ahead, was, zero = self.vector(given), self._was, self._real(0)
        square = squared(was, self._real)
        along = was[0] * ahead[0] + was[1] * ahead[1] + was[2] * ahead[2]
        part = along / square if square > self._real(SMALLEST) else zero
        stays = max(min(part, self._real(1)), zero)
        more = [n - stays * its for n, its in zip(ahead, was, strict=True)]
        growth, slew = np.sqrt(squared(more, self._real)), self._config.slew_n
        if not growth > slew:
            return given, note
        share = slew / growth
        length = self.turn([stays * its + share * n for its, n in zip(was, more, strict=True)])
        return min(length, given), note | LIMITED
