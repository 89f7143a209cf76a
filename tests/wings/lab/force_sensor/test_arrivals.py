"""The sensor's clock is found below late arrivals, whatever its rate against the host's."""

import numpy as np
import pytest

from springpot.host.wings.lab.force_sensor.sensor import ArrivalLine


@pytest.mark.parametrize("rate", [1.0, 1 + 2e-4, 1 - 2e-4])
def test_the_line_below_late_arrivals(rate: float) -> None:
    """Held back by 2 ms on average and 30 now and then: the fastest are what counts."""
    draw = np.random.default_rng(5)
    line = ArrivalLine()
    stamps_s = np.arange(20_000) * 1e-3
    arrived_s = 100.0 + rate * stamps_s + draw.exponential(2e-3, len(stamps_s))
    arrived_s[::500] += 0.03
    arrived_s = np.maximum.accumulate(arrived_s)
    for stamp_s, at_s in zip(stamps_s, arrived_s, strict=True):
        line.add(float(stamp_s), float(at_s))
    for stamp_s in (0.0, 10.0, 19.9):
        assert line.host_s(stamp_s) == pytest.approx(100.0 + rate * stamp_s, abs=0.2e-3)


def test_a_line_needs_a_sample() -> None:
    line = ArrivalLine()
    assert np.isnan(line.host_s(1.0))
    line.add(1.0, 5.0)
    assert line.host_s(2.0) == 6.0
