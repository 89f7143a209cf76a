"""A sensor's thread, each end of which has a line, and its clock below late arrivals."""

import time
from collections.abc import Sequence

import numpy as np
import pytest

from springpot.codegen.errors import DeviceError
from springpot.host.wings.lab.force_sensor.sensor import ArrivalLine, ForceSensor, Stamped


class Source:
    """Gives what it has, then fails, or falls silent."""

    def __init__(self, *batches: Sequence[Stamped] | Exception) -> None:
        self._batches, self.closed = list(batches), False

    def read(self) -> Sequence[Stamped]:
        if not self._batches:
            time.sleep(0.01)
            return []
        batch = self._batches.pop(0)
        if isinstance(batch, Exception):
            raise batch
        return batch

    def close(self) -> None:
        self.closed = True


def batch(first: int, count: int) -> list[Stamped]:
    return [Stamped(1e-3 * k, 0.1 * k) for k in range(first, first + count)]


@pytest.mark.parametrize(
    ("end", "words"),
    [
        (OSError("no such device"), r"went away \(no such device\): check cable and power"),
        (DeviceError("x: unplugged"), "x: unplugged"),
        (batch(0, 1), "time stamps went back"),
    ],
)
def test_what_ends_a_sensor_is_said(end: Sequence[Stamped] | Exception, words: str) -> None:
    source = Source(batch(0, 2000), end)
    sensor = ForceSensor("x", source)
    with pytest.raises(DeviceError, match=words):
        sensor.require_rate()
    times_s, forces_n = sensor.samples()
    assert len(times_s) == 2000
    assert forces_n == pytest.approx([0.1 * k for k in range(2000)])
    sensor.close()
    assert source.closed


def test_silence_is_no_slow_sensor() -> None:
    sensor = ForceSensor("x", Source())
    with pytest.raises(DeviceError, match=r"no sample came in 0\.5 s: check its power"):
        sensor.require_rate()
    sensor.close()


def test_samples_of_one_stamp_count_once() -> None:
    sensor = ForceSensor("x", Source(batch(0, 5), batch(4, 3)))
    time.sleep(0.05)
    assert sensor.samples()[1] == pytest.approx([0.1 * k for k in range(7)])
    sensor.forget()
    assert len(sensor.samples()[0]) == 0
    sensor.close()


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
