"""The fit of psychometric functions: psignifit's data, and intervals that hold the truth."""

import numpy as np
import pytest

from springpot.codegen.errors import DataError
from springpot.host.wings.study.statistics.psychometric import fit_psychometric, psychometric_share

# psignifit's demonstration data: level, right answers; 90 trials each
PSIGNIFIT = np.array([
    [0.0010, 45], [0.0015, 50], [0.0020, 44], [0.0025, 44], [0.0030, 52], [0.0035, 53],
    [0.0040, 62], [0.0045, 64], [0.0050, 76], [0.0060, 79], [0.0070, 88], [0.0080, 90],
    [0.0100, 90],
])  # fmt: skip


def log_posterior(threshold: float, width: float, lapse: float) -> float:
    """Of psignifit's data, where its priors of threshold and width are flat."""
    share = psychometric_share(PSIGNIFIT[:, 0], threshold, width, lapse)
    right = PSIGNIFIT[:, 1]
    answers = right * np.log(share) + (90 - right) * np.log1p(-np.minimum(share, 1 - 1e-12))
    return float(np.sum(answers) + 9.0 * np.log1p(-lapse))


def test_psignifit_data_as_its_matlab_version_fits_them() -> None:
    fit = fit_psychometric(PSIGNIFIT[:, 0], PSIGNIFIT[:, 1], np.full(13, 90))
    assert fit.threshold == pytest.approx(0.0046448472, rel=1e-3)
    assert fit.width == pytest.approx(0.0046838374, rel=6e-3)
    assert fit.lapse == pytest.approx(0.0, abs=1e-6)
    # what is left between the two is its optimiser's tolerance: ours is higher
    theirs = log_posterior(0.0046448472488663396, 0.004683837353547434, 1.0676339572811912e-07)
    ours = log_posterior(fit.threshold, fit.width, fit.lapse)
    assert theirs < ours < theirs + 0.002
    for low, high in (fit.threshold_interval, fit.width_interval, fit.lapse_interval):
        assert low < high
    assert fit.threshold_interval[0] < fit.threshold < fit.threshold_interval[1]
    assert fit.trials == 13 * 90


def test_exact_shares_give_their_parameters_back() -> None:
    levels = np.linspace(0.0, 2.0, 9)
    shares = psychometric_share(levels, 1.1, 0.9, 0.03, 0.5)
    fit = fit_psychometric(levels, 1e5 * shares, np.full(9, 1e5))
    assert (fit.threshold, fit.width) == pytest.approx((1.1, 0.9), rel=2e-3)
    assert fit.lapse == pytest.approx(0.03, abs=1e-3)
    by_hand = (fit.share(np.array([1.1 + 1e-5])) - fit.share(np.array([1.1 - 1e-5]))) / 2e-5
    assert fit.slope == pytest.approx(by_hand[0], rel=1e-3)
    free = fit_psychometric(levels, 1e5 * shares, np.full(9, 1e5), guess=None)
    assert free.guess == pytest.approx(0.5, abs=2e-3)


def test_too_few_levels_are_refused() -> None:
    with pytest.raises(DataError, match=r"2 levels: .* needs answers at 3"):
        fit_psychometric(np.array([1.0, 2.0, 2.0]), np.array([3, 4, 4]), np.array([5, 5, 5]))
    with pytest.raises(DataError, match="more right answers than trials"):
        fit_psychometric(np.arange(3.0), np.array([3, 6, 4]), np.array([5, 5, 5]))


@pytest.mark.slow
def test_95_percent_intervals_hold_the_truth_of_93_to_97_percent_of_1000_observers() -> None:
    rng = np.random.default_rng(8)
    levels, trials = np.linspace(0.0, 2.0, 8), np.full(8, 30)
    held = np.zeros(3)
    for _ in range(1000):
        threshold, width, lapse = rng.uniform(0.7, 1.3), rng.uniform(0.6, 1.4), rng.uniform(0, 0.05)
        right = rng.binomial(trials, psychometric_share(levels, threshold, width, lapse))
        fit = fit_psychometric(levels, right, trials)
        slope = (0.5 - lapse) * 3.289707 / np.sqrt(2 * np.pi) / width
        held += [
            fit.threshold_interval[0] <= threshold <= fit.threshold_interval[1],
            fit.width_interval[0] <= width <= fit.width_interval[1],
            fit.slope_interval[0] <= slope <= fit.slope_interval[1],
        ]
    assert np.all(held >= 930), held
    assert np.all(held <= 970), held


@pytest.mark.parametrize("guess", [0.5, 0.0, None])
@pytest.mark.parametrize("right", [[0] * 5, [9] * 5, [9, 0, 9, 0, 9], [4, 5, 4, 5, 4]])
def test_answers_that_do_not_rise_give_a_wide_interval(
    right: list[int], guess: float | None
) -> None:
    fit = fit_psychometric(np.arange(5.0), np.array(right), np.full(5, 9), guess)
    low, high = fit.threshold_interval
    assert low <= fit.threshold <= high
    assert -2.0 <= low < high <= 6.0  # never beyond half the range outside the levels
    assert high - low > 1.0
    assert 0.0 < fit.slope_interval[0] <= fit.slope_interval[1] < np.inf
