"""Psychometric functions: how the share of right answers rises with a stimulus.

share(x) = guess + (1 - guess - lapse) Phi((x - threshold) 2 z / width), z the 95 % point of the
normal: at the threshold half of the rise is done, over the width the middle 90 % of it. The priors
are those of psignifit 4 (Schuett et al. 2016): flat where the tested levels can tell, falling
beyond them, and lapses are rare. The estimate is where the posterior is highest; an interval holds
the values whose profile, the highest posterior that the other parameters allow, is not
significantly lower. It covers the truth in 93 to 97 % of studies, which the middle 95 % of
psignifit's posterior exceed: 98 % for the width.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import optimize, special, stats

from springpot import DataError
from springpot.basics import Samples

_Z = float(stats.norm.ppf(0.95))
_LEVELS = 3  # that have to be tested: threshold and width, and something to judge them by
_CUT = float(stats.chi2.ppf(0.95, 1)) / 2  # of the log-posterior: what an interval may lose
_TAIL = 4.0  # below the top of the log-posterior, where the second grid ends
_MAX_LAPSE, _MAX_GUESS = 0.4, 0.55  # so that some rise is left between them
_RARE = 10.0  # lapse and guess rates are Beta(1, 10) beforehand
_STEPS = (0.01, 0.05, 0.01, 0.01)  # of the first simplex: spans, log width, lapse, guess


@dataclass(frozen=True)
class PsychometricFit:
    """Parameters with their 95 % intervals; slope: rise of the share per unit, at the threshold."""

    threshold: float
    threshold_interval: tuple[float, float]
    width: float
    width_interval: tuple[float, float]
    slope: float
    slope_interval: tuple[float, float]
    lapse: float
    lapse_interval: tuple[float, float]
    guess: float
    trials: int

    def share(self, levels: Samples) -> Samples:
        """Return share of right answers at levels."""
        return psychometric_share(levels, self.threshold, self.width, self.lapse, self.guess)


def psychometric_share(
    levels: Samples,
    threshold: Samples | float,
    width: Samples | float,
    lapse: Samples | float = 0.0,
    guess: Samples | float = 0.5,
) -> Samples:
    """Return share of right answers at levels, by the formula above."""
    rise = special.ndtr((levels - threshold) * (2.0 * _Z / width))
    return np.asarray(guess + (1.0 - guess - lapse) * rise)


def share_interval(yes: Samples, trials: Samples) -> tuple[Samples, Samples]:
    """Return the 95 % interval of a share (Jeffreys)."""
    ends = (stats.beta.ppf(q, yes + 0.5, trials - yes + 0.5) for q in (0.025, 0.975))
    low, high = (np.asarray(end) for end in ends)
    return low, high


def fit_psychometric(
    levels: Samples, right: Samples, trials: Samples, guess: float | None = 0.5
) -> PsychometricFit:
    """Fit right answers of trials at each level. guess: share of chance; None: to be fitted."""
    levels, right, trials = _pooled(levels, right, trials)
    span = float(levels[-1] - levels[0])
    step = float(np.min(np.diff(levels)))
    free_guess = guess is None

    def log_prior(m: Samples, w: Samples, lapse: Samples, g: Samples) -> Samples:
        beyond = np.maximum(np.maximum(levels[0] - m, m - levels[-1]), 0.0) / (span / 2)
        narrow = np.clip((2.0 * step - w) / step, 0.0, 1.0)
        wide = np.clip((w - span) / (2.0 * span), 0.0, 1.0)
        with np.errstate(divide="ignore"):
            falls = [
                np.log(np.cos(np.pi / 2 * np.minimum(x, 1.0)) ** 2) for x in (beyond, narrow, wide)
            ]
        rare = np.log1p(-lapse) + (np.log1p(-g) if free_guess else 0.0)
        return np.asarray(falls[0] + falls[1] + falls[2] + (_RARE - 1.0) * rare)

    def log_posterior(m: Samples, w: Samples, lapse: Samples, g: Samples) -> Samples:
        total = log_prior(m, w, lapse, g)
        for level, yes, n in zip(levels, right, trials, strict=True):
            share = np.clip(psychometric_share(level, m, w, lapse, g), 1e-9, 1.0 - 1e-9)
            total = total + yes * np.log(share) + (n - yes) * np.log1p(-share)
        return total

    axes = [
        np.linspace(levels[0] - 0.5 * span, levels[-1] + 0.5 * span, 41)[1:-1],
        np.geomspace(1.01 * step, 2.99 * span, 40),
        np.linspace(0.0, _MAX_LAPSE, 21),
        np.linspace(0.0, _MAX_GUESS, 12) if free_guess else np.array([guess]),
    ]
    coarse = log_posterior(*np.meshgrid(*axes, indexing="ij", sparse=True))
    fine = [_narrowed(coarse, axes, i, points) for i, points in enumerate((49, 49, 25, 13))]
    m, w, lapse, g = np.meshgrid(*fine, indexing="ij", sparse=True)
    heights = log_posterior(m, w, lapse, g)
    place = np.unravel_index(heights.argmax(), heights.shape)
    start = [axis[i] for axis, i in zip(fine, place, strict=True)]
    best = _refined(log_posterior, start, free_guess, span)
    steepest = _slope(fine[1][0], lapse.min(), g.min())
    flattest = np.maximum(_slope(fine[1][-1], lapse.max(), g.max()), 1e-3 * steepest)
    slopes = np.geomspace(flattest, steepest, 2 * len(fine[1]))
    steep = log_posterior(m, _slope(slopes[None, :, None, None], lapse, g), lapse, g)
    return PsychometricFit(
        best[0], _interval(heights, 0, fine[0]), best[1], _interval(heights, 1, fine[1]),
        _slope(*np.array(best[1:])).item(), _interval(steep, 1, slopes),
        best[2], _interval(heights, 2, fine[2]), best[3], int(trials.sum()),
    )  # fmt: skip


def _pooled(levels: Samples, right: Samples, trials: Samples) -> tuple[Samples, Samples, Samples]:
    """Add up the answers of each level, in rising order."""
    places, which = np.unique(np.asarray(levels, dtype=float), return_inverse=True)
    if len(places) < _LEVELS or not np.all(np.isfinite(places)):
        raise DataError(
            f"{len(places)} levels: a psychometric function needs answers at {_LEVELS} of them"
        )
    yes, n = (np.bincount(which, np.asarray(x, dtype=float)) for x in (right, trials))
    if np.any(yes < 0.0) or np.any(yes > n) or np.any(n <= 0.0):
        raise DataError("more right answers than trials at a level, or a level without trials")
    return np.asarray(places), np.asarray(yes), np.asarray(n)


def _slope(width: Samples, lapse: Samples, guess: Samples) -> Samples:
    """Return slope at the threshold of a width; and the width of a slope."""
    return np.asarray((1.0 - guess - lapse) * (2.0 * _Z / (2.0 * np.pi) ** 0.5) / width)


def _narrowed(log_posterior: Samples, axes: list[Samples], i: int, points: int) -> Samples:
    """Return the part of an axis with a posterior worth a fine grid, one coarse step wider."""
    axis = axes[i]
    if len(axis) == 1:
        return axis
    height = log_posterior.max(axis=tuple({0, 1, 2, 3} - {i}))
    kept = np.flatnonzero(height > height.max() - _TAIL)
    low, high = axis[max(kept[0] - 1, 0)], axis[min(kept[-1] + 1, len(axis) - 1)]
    return np.geomspace(low, high, points) if i == 1 else np.linspace(low, high, points)


def _refined(
    log_posterior: Callable[..., Samples],
    start: list[np.float64],
    free_guess: bool,
    span: float,
) -> list[float]:
    """Return the highest point near a point of the grid."""

    free = 4 if free_guess else 3

    def parameters(x: Samples) -> list[np.float64]:
        return [x[0] * span, np.exp(x[1]), *x[2:], *start[free:]]

    def height(x: Samples) -> float:
        return -float(np.maximum(log_posterior(*parameters(x)), -1e9))

    first = np.array([start[0] / span, np.log(start[1]), *start[2:free]])
    found = optimize.minimize(
        height, first, method="Nelder-Mead",
        bounds=[(None, None), (None, None), (0.0, _MAX_LAPSE), (0.0, _MAX_GUESS)][:free],
        options={"initial_simplex": np.vstack([first, first + np.diag(_STEPS[:free])]),
                 "xatol": 1e-7, "fatol": 1e-9, "maxiter": 2000},
    )  # fmt: skip
    return [float(value) for value in parameters(found.x)]


def _interval(heights: Samples, i: int, values: Samples) -> tuple[float, float]:
    """Return where the profile along an axis is less than the cut below its top."""
    along = heights.max(axis=tuple({0, 1, 2, 3} - {i}))
    above = along - along.max() + _CUT
    kept = np.flatnonzero(above >= 0.0)
    ends = []
    for inner, outer in ((kept[0], kept[0] - 1), (kept[-1], kept[-1] + 1)):
        if not 0 <= outer < len(values):
            ends.append(float(values[inner]))
            continue
        share = above[inner] / (above[inner] - max(above[outer], -1e9))
        ends.append(float(values[inner] + share * (values[outer] - values[inner])))
    return ends[0], ends[1]
