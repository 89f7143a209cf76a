"""Reference of a coupling whose proxy the model sees: its motion depends on the model's force."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.tick import Coupled, shaped
from springpot.codegen.stages.stage import Starts

ModelForce = Callable[[Reals, Starts, NDArray[np.bool_]], Reals]
_CHUNK = 1024  # ticks guessed at a time, at most
_LEAST = 8  # at least: what a pass costs by itself
_AHEAD = 4  # times the ticks that the last pass proved


@dataclass(frozen=True, eq=False)
class Touch:
    """What the coupling sees of a run: tool position and velocity, contact, restarts."""

    position: Reals
    velocity: Reals
    contact: NDArray[np.bool_]
    starts: Starts

    @property
    def placed(self) -> NDArray[np.bool_]:
        """Ticks at which the proxy is set to the tool: contact begins, or history restarts."""
        begins = self.contact & ~np.concatenate([[False], self.contact[:-1]])
        begins[self.starts] = self.contact[self.starts]
        return np.asarray(begins)

    def restart_before(self, tick: int) -> int:
        """The last restart at or before a tick; the first tick where there was none."""
        found = int(np.searchsorted(self.starts, tick, side="right"))
        return int(self.starts[found - 1]) if found else 0


def proxy_motion(plan: Plan, touch: Touch, force: ModelForce, guess_m: Reals | None) -> Reals:
    """Where the model looks at each tick, m, shape (n,): the proxy, or the tool in free air.

    Guess and proof: the stages' references take whole motions, but the proxy's next position
    needs the force here. So force is evaluated on a guessed motion, the proxy stepped with it, and
    every tick up to the first that differs is exact: its past was. What follows is a better guess.
    A pass begins at the last restart, which forgets what was before, and reaches a few times as far
    as the last one proved: in a stiff object a wrong tick makes the rest of a long guess useless.
    force(motion, starts, asked): the model's force on a motion where `asked`. guess_m: the motion
    that the C reports, which makes one pass do.
    """
    coupled = _Stepper(plan, touch)
    pressed = touch.position.copy()
    if guess_m is not None:
        guessed = touch.contact & ~touch.placed
        pressed[guessed] = guess_m[guessed]
    total = len(pressed)
    done, chunk = 0, _CHUNK if guess_m is None else total
    while done < total:
        end = min(total, done + chunk)
        begin = touch.restart_before(done)
        asked = touch.contact[begin:end].copy()
        asked[: done - begin] = False
        starts = touch.starts[(touch.starts >= begin) & (touch.starts < end)] - begin
        motion = pressed[begin:end]
        model_n = shaped(plan, motion, force(motion, starts, asked))
        proven = coupled.prove(pressed, model_n[done - begin :], done, end)
        chunk = min(_CHUNK, max(_LEAST, _AHEAD * (proven - done)))
        done = proven
    return pressed


class _Stepper:
    def __init__(self, plan: Plan, touch: Touch) -> None:
        assert plan.couple is not None
        self._coupled = Coupled(plan.couple)
        self._touch = touch
        self._placed = touch.placed

    def prove(self, pressed: Reals, model_n: Reals, begin: int, end: int) -> int:
        """Step through ticks begin .. end; correct `pressed`; return the first unproven tick.

        model_n: force of those ticks on the guess.
        """
        proven = end
        for i in range(begin, end):
            proxy = self._coupled.proxy
            if self._tick(pressed, model_n[i - begin], i) and proven == end:
                proven, at_proof = i, proxy
        if proven < end:
            self._coupled.proxy = at_proof
        return proven

    def _tick(self, pressed: Reals, model_n: Any, i: int) -> bool:
        """One tick; returns whether the guessed position was wrong."""
        touch = self._touch
        if self._placed[i] or not touch.contact[i]:
            self._coupled.proxy = None
        if not touch.contact[i]:
            return False
        x, v = touch.position[i], touch.velocity[i]
        at = self._coupled.place(x, v)
        wrong = bool(at != pressed[i]) and not (np.isnan(at) and np.isnan(pressed[i]))
        pressed[i] = at
        self._coupled.force(x, v, model_n)
        return wrong
