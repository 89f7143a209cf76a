"""Simulated people: they press what is emitted, feel with a known threshold, and answer.

Force is felt on a logarithmic scale (Weber), with Gaussian noise on every presentation; the noise
of one presentation is ln(1 + the Weber fraction), so that a pair that differs by just that has a
d' of 1 (Green & Swets 1966). Force is compared at equal depth, while pressing in.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from springpot.basics import Samples
from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.session.screen_state import answers

_WEBER, _WEBER_SPREAD = 0.10, 0.2  # of force, at 2 N and more (the paper's figure 8); of its log
_DEPTHS = np.linspace(0.3, 0.9, 25)  # of the depth that all presses of a trial reached


@dataclass(frozen=True)
class Observer:
    """A person. weber: just noticeable change of force. lapse: share of answers at random.

    lowest, highest: ratings of entirely different, and of the same. fall_jnds: the difference, in
    just noticeable ones, over which a rating falls to 1/e. rating_sd: of ratings of the same thing.
    criterion: same-different: what is called different, in standard deviations of one feeling.
    """

    weber: float
    lapse: float = 0.0
    lowest: float = 5.0
    highest: float = 90.0
    fall_jnds: float = 10.0
    rating_sd: float = 6.0
    criterion: float = 1.5

    @classmethod
    def drawn(cls, random: np.random.Generator) -> "Observer":
        """Draw a person of a population."""
        return cls(
            weber=_WEBER * math.exp(_WEBER_SPREAD * random.standard_normal()),
            lapse=float(random.uniform(0, 0.03)),
            lowest=float(random.uniform(0, 12)),
            highest=float(random.uniform(80, 98)),
            fall_jnds=float(random.uniform(7, 14)),
            rating_sd=float(random.uniform(3, 9)),
            criterion=float(random.uniform(1.0, 2.0)),
        )

    @property
    def sd(self) -> float:
        """Standard deviation of one feeling, in the logarithm of force."""
        return math.log1p(self.weber)

    def as_dict(self) -> dict[str, float]:
        return asdict(self)


@dataclass(frozen=True, eq=False)
class FeltPress:
    """A press as it was felt: position_m and force_n, (n,)."""

    position_m: Samples
    force_n: Samples

    @property
    def depth_m(self) -> float:
        return float(self.position_m.max(initial=0.0))


def felt_strengths(presses: Sequence[FeltPress]) -> Samples:
    """Mean logarithm of the force at equal depths while pressing in, one value a press."""
    depths_m = _DEPTHS * min(press.depth_m for press in presses)
    found = np.zeros(len(presses))
    for k, press in enumerate(presses):
        deepest = int(press.position_m.argmax()) + 1
        position_m = np.maximum.accumulate(press.position_m[:deepest])
        force_n = np.interp(depths_m, position_m, press.force_n[:deepest])
        found[k] = float(np.mean(np.log(np.maximum(force_n, 1e-3))))
    return found


def answer(
    observer: Observer, study: Study, presses: Sequence[FeltPress], random: np.random.Generator
) -> float | str:
    """Return what the observer says of the presses of a trial, in the order of its slots."""
    felt = felt_strengths(presses) + observer.sd * random.standard_normal(len(presses))
    choices = answers(study)
    lapses = random.uniform() < observer.lapse
    if not choices:
        return _rating(observer, abs(felt[1] - felt[0]), lapses, random)
    if lapses:
        return choices[int(random.integers(len(choices)))]
    if study.method == "abx":
        return "A" if abs(felt[2] - felt[0]) < abs(felt[2] - felt[1]) else "B"
    if study.method == "same-different":
        return "same" if abs(felt[1] - felt[0]) < observer.criterion * observer.sd else "different"
    return "left" if felt[0] > felt[1] else "right"


def _rating(
    observer: Observer, difference: float, lapses: bool, random: np.random.Generator
) -> float:
    """Rate from 0 to 100: it falls with the difference, and few people use the ends."""
    if lapses:
        return float(random.integers(101))
    share = math.exp(-difference / observer.sd / observer.fall_jnds)
    rating = observer.lowest + (observer.highest - observer.lowest) * share
    return float(np.clip(round(rating + observer.rating_sd * random.standard_normal()), 0, 100))
