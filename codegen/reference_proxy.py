"""Reference of a coupling whose proxy the model sees: its motion depends on the model's force."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.plan import Plan
from springpot.codegen.reference_tick import Coupled, shaped
from springpot.codegen.stages.stage import Starts

Reals = NDArray[Any]
ModelForce = Callable[[Reals, NDArray[np.bool_]], Reals]
_CHUNK = 1024  # ticks guessed at a time


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


def proxy_motion(plan: Plan, touch: Touch, force: ModelForce, guess_m: Reals | None) -> Reals:
    """Where the model looks at each tick, m, shape (n,): the proxy, or the tool in free air.

    Guess and proof: the stages' references take whole motions, but the proxy's next position
    needs the force here. So force is evaluated on a guessed motion, the proxy stepped with it, and
    every tick up to the first that differs is exact: its past was. What follows is a better guess.
    force(motion, asked): the model's force on a motion where `asked`. guess_m: the motion that the
    C reports, which makes one pass do.
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
        asked = touch.contact[:end].copy()
        asked[:done] = False
        model_n = shaped(plan, pressed[:end], force(pressed[:end], asked))
        done = coupled.prove(pressed, model_n, done, end)
        chunk = _CHUNK
    return pressed


class _Stepper:
    def __init__(self, plan: Plan, touch: Touch) -> None:
        assert plan.couple is not None
        self._coupled = Coupled(plan.couple)
        self._touch = touch
        self._placed = touch.placed

    def prove(self, pressed: Reals, model_n: Reals, begin: int, end: int) -> int:
        """Step through ticks begin .. end; correct `pressed`; return the first unproven tick."""
        proven = end
        for i in range(begin, end):
            proxy = self._coupled.proxy
            if self._tick(pressed, model_n, i) and proven == end:
                proven, at_proof = i, proxy
        if proven < end:
            self._coupled.proxy = at_proof
        return proven

    def _tick(self, pressed: Reals, model_n: Reals, i: int) -> bool:
        """One tick; returns whether the guessed position was wrong."""
        touch = self._touch
        if self._placed[i] or not touch.contact[i]:
            self._coupled.proxy = None
        if not touch.contact[i]:
            return False
        x, v = touch.position[i], touch.velocity[i]
        at = self._coupled.place(x, v)
        wrong = bool(at != pressed[i])
        pressed[i] = at
        self._coupled.force(x, v, model_n[i])
        return wrong
