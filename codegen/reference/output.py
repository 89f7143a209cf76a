"""The reference of what leaves: sp_output.h and sp_energy.h, tick by tick."""

from typing import Any

from springpot.codegen.plan.energy import EnergyConfig
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.notes import CLAMPED, ENERGY, HELD, LATCHED, LIMITED, RAMPED
from springpot.codegen.stages.stage import bounded, flushed

ENERGY_DOUBT, ENERGY_PLAY = 1.5, 0.6875  # SP_ENERGY_DOUBT, SP_ENERGY_PLAY


class Output:
    """Keep the force of the last call, and bound the next one by it."""

    def __init__(self, plan: Plan, account: "Account | None" = None) -> None:
        self._config = plan.output
        self._real = plan.dtype
        self._acts = plan.energy_acts
        self._viscous = plan.viscous_npm
        self._account = account
        if account is None and plan.energy is not None:
            self._account = Account(plan.energy, plan.dtype)
        # One tick in ticks, as the C has it: 1 but for rounding.
        self._tick = plan.silence.dt_s * plan.silence.per_dt
        self.given: Any = self._real(0)
        self._share: Any = self._real(0)
        self._rise: Any = self._real(0)

    def restart(self, x: Any) -> None:
        """The ramp begins again at the position x, m."""
        self._share, self._rise = self._real(0), self._config.rise
        if self._account is not None:
            self._account.restart(x)

    def free(self) -> None:
        """No contact."""
        self._share = self._real(1)

    def hold(self, latched: Any, silent: Any, fall: Any, share: Any) -> tuple[Any, int]:
        """A tick without a good sample, after `silent` of them; fall: how much of it was latched.

        Force, N, and notes.
        """
        held, self.given, note = self.given, share * self.given, HELD
        if self._account is not None and self._acts:
            self.given, cut = self._account.wait(silent, self._tick - fall, held, self.given)
            note |= cut
        if latched:
            return self._fall(fall), LATCHED
        return self.given, note

    def pay(self, x: Any, ticks: Any, way: Any, step: Any) -> Any:
        """Good sample at x, m, so many ticks and so far from the one before; step: in a tick, m.

        Returns the step, m, that the tool may go on by.
        """
        if self._account is None:
            return step
        damped = self._real(0) if self._viscous is None else self._viscous * step * way
        return self._account.pay(self.given, self.held(ticks), x, ticks, step, damped)

    def held(self, ticks: Any) -> Any:
        """Force that was given before the silence, N, if the sample is so many ticks late."""
        silent = self._account is not None and self._acts and ticks > 1
        return self._account.held if silent and self._account is not None else self.given

    def force(self, latched: Any, after_silence: bool, step: Any, force: Any) -> tuple[Any, int]:
        """Return what leaves of the model's force at a good sample, N, and notes."""
        if latched:
            return self._fall(self._real(1)), LATCHED
        note = 0
        if after_silence:
            self._resume(force)
        if self._share < 1:
            force = force * self._share
            self._share = self._share + self._rise * self._real(1)
            note |= RAMPED
        force, clamped = self._clamped(force)
        self.given, limited = self._slewed(force)
        note |= clamped | limited
        if self._account is not None:
            cut, cuts = self._account.limit(step, self.given)
            note |= cuts
            self.given = cut if self._acts else self.given
        return self.given, note

    def _before(self, force: Any) -> Any:
        given, zero = self.given, self._real(0)
        return max(given, zero) if force > 0 else min(given, zero)

    def _resume(self, force: Any) -> None:
        before, now = abs(self._before(force)), abs(force)
        share = before / now if before < now else self._real(1)
        if share < 1 and share < self._share:
            self._rise = self._rise if self._share < 1 else self._config.back
            self._share = share + self._rise

    def _clamped(self, force: Any) -> tuple[Any, int]:
        min_n, max_n = self._config.min_n, self._config.max_n
        if min_n <= force <= max_n:
            return force, 0
        beyond = min_n if force < min_n else self._real(0)
        return (max_n if force > max_n else beyond), CLAMPED

    def _slewed(self, force: Any) -> tuple[Any, int]:
        slew = self._config.slew_n * self._real(1)
        before = self._before(force)
        most, least = before + slew, before - slew
        if force > 0:
            return (most, LIMITED) if force > most else (force, 0)
        return (least, LIMITED) if force < least else (force, 0)

    def _fall(self, ticks: Any) -> Any:
        step = self._config.fall_n * ticks
        down, up = self.given - step, self.given + step
        self.given = down if down > 0 else up if up < 0 else self._real(0)
        return self.given


class Account:
    """sp_energy.h."""

    def __init__(self, config: EnergyConfig, real: type[Any]) -> None:
        self._config = config
        self._real = real
        self.restart(real(0))

    def most(self, x: Any) -> Any:
        config = self._config
        way = x - config.from_m
        u = way if way > 0 else self._real(0)
        return config.most_j + u * (config.push_n + u * config.stiffness_npm)

    def restart(self, x: Any) -> None:
        self.left: Any = self.most(x)
        self.position: Any = x
        self.looked: Any = x
        zero = self._real(0)
        self.ticks: Any = zero
        self.step: Any = zero
        self.bend: Any = zero
        self.turn: Any = zero
        self.held: Any = zero
        self.rest: Any = x

    def pay(self, given: Any, held: Any, x: Any, ticks: Any, step: Any, damped: Any) -> Any:
        moved = x - self.position
        left = self.left + damped
        if abs(moved) > self._config.slack_m:
            left = left + min(given * moved, held * moved)
            self.position = x
        self.left = bounded(min(left, self.most(x)))
        self.ticks = self.ticks + ticks
        if self.ticks >= self._config.look_ticks:
            self._look(x)
        self.rest, on = self.on(self.rest, x, step)
        return on

    def on(self, rest: Any, x: Any, step: Any) -> tuple[Any, Any]:
        """sp_energy_on: where the tool is but for noise, and its step."""
        play = self._real(ENERGY_PLAY) * self._config.slack_m
        inwards, outwards = x - play, x + play
        if inwards > rest or outwards < rest:
            return (inwards if inwards > rest else outwards), step
        return rest, self._real(0)

    def _look(self, x: Any) -> None:
        way = x - self.looked
        moved = way if abs(way) > self._config.slack_m else self._real(0)
        per_tick = self._real(1) / self.ticks
        step = moved * per_tick
        bend = (step - self.step) * per_tick
        turn = flushed(self.turn * self._config.keep)
        self.step, self.bend = step, bend
        self.turn = abs(bend) if abs(bend) > turn else turn
        self.looked, self.ticks = x, self._real(0)

    def limit(self, step: Any, force: Any) -> tuple[Any, int]:
        asked = -(force * step)
        may = self.left * self._real(0.5) if self.left > 0 else self._real(0)
        if not asked > may:
            return force, 0
        share = may / asked
        return (force * share if share < 1 else force), ENERGY

    def _share_at(self, depth: Any, to: Any) -> Any:
        if not to < depth or not depth > 0:
            return self._real(1)
        share = to / depth if to > 0 else self._real(0)
        return share * share if share < 1 else self._real(1)

    def wait(self, silent: Any, ticks: Any, held: Any, given: Any) -> tuple[Any, int]:
        note, half = 0, self._real(0.5)
        if not silent > 0:
            self.held = held
        begin = int(silent + half)
        for i in range(begin, int(silent + ticks + half) if ticks > 0 else begin):
            at = self._real(i + 1)
            on = self.step + at * self.bend
            turned = at * (self._real(ENERGY_DOUBT) * self.turn)
            step = on - turned if held > 0 else on + turned
            work = held * step
            if work < 0:
                depth = self.position - self._config.from_m
                self.left = bounded(self.left + work)
                self.position = bounded(self.position + step)
                given = given * self._share_at(depth, depth + on)
                given, cut = self.limit(step, given)
                note |= cut
        return given, note
