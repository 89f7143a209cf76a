"""Figures of an error, beside the noise floor and the just noticeable difference."""

import numpy as np
import pytest

from springpot.host.metrics import accuracy, just_noticeable_n, start_up_ramp
from springpot.host.validation.compared import bits_differ


def test_figures_of_a_known_error() -> None:
    measured = [np.array([0.0, 4.0, 10.0, 3.0]), np.array([5.0, 5.0])]
    predicted = [np.array([1.0, 4.0, 10.0, 3.6]), np.array([5.0, 5.4])]
    found = accuracy(measured, predicted)
    assert found.samples == 6
    assert found.rmse_n == pytest.approx(np.sqrt((1 + 0.36 + 0.16) / 6))
    assert found.rmse_percent_of_peak == pytest.approx(10 * found.rmse_n)
    each = [np.sqrt(1.36 / 4), np.sqrt(0.16 / 2)]
    assert found.mean_recording_rmse_n == pytest.approx(np.mean(each))
    assert min(each) - 1e-12 <= found.interval_n[0] <= found.interval_n[1] <= max(each) + 1e-12
    assert found.max_abs_error_n == 1.0
    # Above 2 N: 0, 0, 20 %, 0, 8 %.
    assert found.ape_below_jnd == pytest.approx(4 / 5)


def test_one_recording_has_no_interval_and_weak_forces_no_score() -> None:
    found = accuracy([np.array([0.5, 1.0])], [np.array([0.5, 1.5])])
    assert found.interval_n is None
    assert found.ape_below_jnd is None


def test_the_start_up_ramp_is_counted_apart() -> None:
    measured, predicted = np.full(5, 4.0), np.array([0.0, 2.0, 4.0, 4.4, 4.0])
    notes = np.array([16, 16 | 64, 0, 16, 0])
    assert start_up_ramp(notes) == 2
    found = accuracy([measured], [predicted], [2])
    assert (found.samples, found.ramped) == (5, 2)
    assert found.rmse_n == pytest.approx(0.4 / np.sqrt(3))
    assert found.max_abs_error_n == pytest.approx(0.4)
    assert start_up_ramp(np.full(3, 16)) == 0  # nothing else there: all count


def test_the_just_noticeable_difference_rises_below_two_newton() -> None:
    np.testing.assert_allclose(just_noticeable_n(np.array([0.5, 2.0, 9.0])), [0.2, 0.2, 0.9])


def test_an_interval_holds_the_mean_in_19_of_20_draws() -> None:
    """Span 1.96 standard errors of the mean to either side, for many recordings."""
    spread = np.random.default_rng(0).normal(1.0, 0.1, 400)
    found = accuracy([np.full(2, 4.0)] * 400, [np.full(2, 4.0 + error) for error in spread])
    assert found.interval_n is not None
    low, high = found.interval_n
    expected = 2.0 * 1.96 * spread.std() / np.sqrt(400)
    assert high - low == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_one_bit_is_a_difference(dtype: type[np.float32] | type[np.float64]) -> None:
    """See one bit: "0 ticks differ" stands on it."""
    one = np.array([0.0, 1.0, 3.5], dtype=dtype)
    assert not bits_differ(one, one.copy()).any()
    assert bits_differ(one, np.nextafter(one, dtype(9.0))).all()
    assert bits_differ(one, np.array([-0.0, 1.0, 3.5], dtype=dtype)).sum() == 1
