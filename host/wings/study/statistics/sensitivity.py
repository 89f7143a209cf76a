"""How well a person distinguishes two stimuli: d', free of a person's bias, with its interval.

Each method asks two kinds of trials, and a person answers "yes" to each with some rate. In choices
of two and in ABX, yes is the first of two answers, and the kinds are those where it is right and
where the other one is. In same-different, yes is "different", and the kinds are pairs that differ
and pairs that do not. ABX and same-different are read by the differencing model: what a person
compares are the differences felt (Macmillan and Creelman 2005, chapter 9).

Half a yes and half a no more are counted in each kind (Hautus 1995), for the estimate as for the
interval, which is where the profile of the likelihood has lost no more than chance would.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from scipy import optimize, stats

from springpot import DataError, UsageError
from springpot.basics import Samples

_CUT = float(stats.chi2.ppf(0.95, 1)) / 2  # of the log-likelihood: what a 95 % interval may lose
_LARGEST = 6.0  # a d' that no study of people can tell from infinity
_EXTREME = 1e-12  # a rate closer to 0 or 1 would have a log-likelihood without end


@dataclass(frozen=True)
class Sensitivity:
    """d' and its 95 % interval, whose end is infinite if the answers do not bound it."""

    method: str
    d_prime: float
    low: float
    high: float
    hit_rate: float
    false_alarm_rate: float
    trials: int


def sensitivity(
    method: str, hits: int, signals: int, false_alarms: int, noises: int
) -> Sensitivity:
    """hits: yes in trials of the first kind, of which there are signals; false_alarms: yes in those
    of the second, noises."""
    if method not in _MODELS:
        raise UsageError(f"method {method}: give one of {', '.join(_MODELS)}")
    if not (0 <= hits <= signals and 0 <= false_alarms <= noises and signals and noises):
        raise DataError(
            f"{hits} of {signals} and {false_alarms} of {noises}: d' needs trials of both kinds"
        )
    counts = np.array([hits, signals - hits, false_alarms, noises - false_alarms]) + 0.5
    d = _GRIDS[method]
    likelihood = np.max(np.tensordot(counts, _logs(method), 1), axis=1)  # over the person's bias
    kept = np.flatnonzero(likelihood >= likelihood.max() - _CUT)
    d_prime = _estimate(method, counts[0] / (signals + 1.0), counts[2] / (noises + 1.0))
    low = _crossing(d, likelihood, kept[0], -1)
    high = _crossing(d, likelihood, kept[-1], 1)
    return Sensitivity(
        method,
        d_prime,
        min(low, d_prime),
        max(high, d_prime),
        hits / signals,
        false_alarms / noises,
        signals + noises,
    )


def abx_correct(d: Samples) -> Samples:
    """Return share of right answers of an unbiased person, ABX by differences."""
    wide, narrow = d / 2**0.5, d / 6**0.5
    right = stats.norm.cdf(wide) * stats.norm.cdf(narrow)
    return np.asarray(right + stats.norm.cdf(-wide) * stats.norm.cdf(-narrow))


def different_rate(d: Samples, criterion: Samples) -> Samples:
    """Return the rate of "different" to stimuli d apart; criterion: felt difference, > 0."""
    above = stats.norm.sf((criterion - d) / 2**0.5)
    return np.asarray(above + stats.norm.cdf((-criterion - d) / 2**0.5))


def _choice_rates(d: Samples, bias: Samples) -> tuple[Samples, Samples]:
    half = d / 2**0.5
    return stats.norm.cdf(half - bias), stats.norm.cdf(-half - bias)


def _abx_rates(d: Samples, bias: Samples) -> tuple[Samples, Samples]:
    half = stats.norm.ppf(abx_correct(d))
    return stats.norm.cdf(half - bias), stats.norm.cdf(-half - bias)


def _different_rates(d: Samples, bias: Samples) -> tuple[Samples, Samples]:
    criterion = np.exp(bias)
    return different_rate(d, criterion), different_rate(0.0 * d, criterion)


_Model = Callable[[Samples, Samples], tuple[Samples, Samples]]
_MODELS: dict[str, _Model] = {
    "2afc": _choice_rates,
    "abx": _abx_rates,
    "same-different": _different_rates,
}
_BIASES = np.linspace(-4.0, 2.4, 321)  # for same-different, of the criterion's logarithm
_GRIDS = {
    name: np.linspace(-_LARGEST if name == "2afc" else 0.0, _LARGEST, 601) for name in _MODELS
}


@cache
def _logs(method: str) -> Samples:
    """Return logarithms of the rates of yes and no to both kinds, on the grid of d' and bias."""
    shift = 0.0 if method == "same-different" else 0.8
    rates = _MODELS[method](_GRIDS[method][:, None], _BIASES[None] + shift)
    yes, alarms = (np.clip(rate, _EXTREME, 1.0 - _EXTREME) for rate in rates)
    return np.stack([np.log(yes), np.log1p(-yes), np.log(alarms), np.log1p(-alarms)])


def _estimate(method: str, yes: float, alarms: float) -> float:
    """Return d' that gives these two rates exactly; 0 for a person below chance."""
    apart = float(stats.norm.ppf(yes) - stats.norm.ppf(alarms))
    if method == "2afc":
        return apart / 2**0.5
    if method == "abx":
        target, curve = float(stats.norm.cdf(apart / 2)), abx_correct
    else:
        target = yes
        criterion = np.asarray(-(2**0.5) * stats.norm.ppf(alarms / 2))
        curve = partial(different_rate, criterion=criterion)
    if target <= curve(np.zeros(())):
        return 0.0
    return float(optimize.brentq(lambda d: float(curve(d)) - target, 0.0, 4 * _LARGEST))


def _crossing(d: Samples, likelihood: Samples, at: int, step: int) -> float:
    """Return where the likelihood falls below the cut, between a place of the grid and the next."""
    beyond = at + step
    if not 0 <= beyond < len(d):
        return float(d[at]) if step < 0 and d[0] == 0.0 else step * np.inf
    edge = likelihood.max() - _CUT
    share = (likelihood[at] - edge) / (likelihood[at] - likelihood[beyond])
    return float(d[at] + share * (d[beyond] - d[at]))
