"""What becomes of a sensor's thread: each end has a line, and nothing is kept of what is wrong."""

import time
from collections.abc import Sequence

import pytest

from springpot.codegen.errors import DeviceError
from springpot.host.wings.lab.force_sensor.sensor import ForceSensor, Stamped


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
