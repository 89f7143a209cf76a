"""QUEST+: the next stimulus is the one whose answer is expected to tell most (Watson 2017).

A grid of parameters holds how likely each is after the answers so far. For every stimulus the
answer and what it would leave unknown, the entropy over the grid, is averaged over right and wrong.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from math import erf

import numpy as np

from springpot import UsageError
from springpot.basics import Samples

Share = Callable[..., Samples]  # of right answers: of levels and parameters by name


@dataclass(frozen=True)
class QuestPlus:
    """Levels that can be shown, the grid of every parameter, and the share of right answers.

    Every answer of a level is right or wrong; the levels shown come back with the answers, so that
    a history alone says what is next."""

    levels: tuple[float, ...]
    parameters: Mapping[str, Sequence[float]]
    share: Share
    _grid: Samples = field(init=False, repr=False, compare=False)
    _right: Samples = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not self.levels or not all(self.parameters.values()):
            raise UsageError("QUEST+ needs a level, and a value of every parameter")
        grid = np.array(list(product(*self.parameters.values())), dtype=float)
        columns = dict(zip(self.parameters, grid.T, strict=True))
        right = np.stack([self.share(np.float64(level), **columns) for level in self.levels])
        if not np.all((right >= 0.0) & (right <= 1.0)):
            raise UsageError("QUEST+: a share of right answers that is not between 0 and 1")
        object.__setattr__(self, "_grid", grid)
        object.__setattr__(self, "_right", right)  # (levels, grid)

    def next_level(self, shown: Sequence[float], answers: Sequence[bool]) -> float:
        """Return the level whose answer is expected to tell most; of equals, the first."""
        posterior = self.posterior(shown, answers)
        expected = np.zeros(len(self.levels))
        for outcome in (self._right, 1.0 - self._right):
            joint = posterior * outcome
            likely = joint.sum(axis=1)
            # - sum p log p of joint / likely, times likely, without dividing by what may be zero
            expected += _x_log_x(likely) - _x_log_x(joint).sum(axis=1)
        return self.levels[int(np.argmin(np.round(expected, 14)))]  # 14: equal but for rounding

    def posterior(self, shown: Sequence[float], answers: Sequence[bool]) -> Samples:
        """Return how likely each point of the grid is, summing to one."""
        log_likelihood = np.zeros(len(self._grid))
        with np.errstate(divide="ignore"):
            for level, right in zip(shown, answers, strict=True):
                share = self._right[self._place(level)]
                log_likelihood += np.log(share if right else 1.0 - share)
        if not np.any(np.isfinite(log_likelihood)):
            raise UsageError("QUEST+: answers that no parameters of the grid can give")
        weights = np.exp(log_likelihood - log_likelihood.max())
        return np.asarray(weights / weights.sum())

    def _place(self, level: float) -> int:
        try:
            return self.levels.index(level)
        except ValueError:
            raise UsageError(f"QUEST+: {level:g} is no level of this study") from None


def cumulative_normal(
    level: Samples, threshold: Samples, deviation: Samples, guess: Samples, lapse: Samples
) -> Samples:
    """Return normal distribution's function between guess and 1 - lapse."""
    rise = 0.5 + 0.5 * np.vectorize(erf)((level - threshold) / deviation / 2**0.5)
    return np.asarray(guess + (1.0 - guess - lapse) * rise)


def _x_log_x(x: Samples) -> Samples:
    return np.asarray(x * np.log(np.where(x > 0.0, x, 1.0)))
