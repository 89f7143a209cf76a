"""A load cell on a line of its own: its clock, what ends it, what is refused."""

import threading
import time
from array import array
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.peer import peer

from springpot.codegen.errors import DeviceError
from springpot.host.devices.wire import constant
from springpot.host.recording.indentation import Limits
from springpot.host.recording.sensed_press import ForceSensor, SensedPressDevice, opened_sensor


def heard(*rows: tuple[float, float, float]) -> Any:
    """A sensor that has taken samples: stamp, arrival, force."""
    taken = array("d", [value for row in rows for value in row])
    return SimpleNamespace(_samples=taken, _lock=threading.Lock(), url="x", _factor=-2.0,
                           on_force=lambda _force_n: None)  # fmt: skip


@pytest.mark.parametrize("rate", [1.0, 1 + 2e-4, 1 - 2e-4])
def test_the_line_below_late_arrivals(rate: float) -> None:
    """Held back by 2 ms on average and 30 now and then: the fastest are what counts."""
    draw, stamps_s = np.random.default_rng(5), np.arange(20_000) * 1e-3
    arrived_s = 100.0 + rate * stamps_s + draw.exponential(2e-3, len(stamps_s))
    arrived_s[::500] += 0.03
    arrived_s = np.maximum.accumulate(arrived_s)
    rows = zip(stamps_s.tolist(), arrived_s.tolist(), stamps_s.tolist(), strict=True)
    times_s, forces_n = ForceSensor.samples(heard(*rows))
    np.testing.assert_allclose(times_s, 100.0 + rate * stamps_s, atol=0.3e-3)
    np.testing.assert_array_equal(forces_n, stamps_s)


def test_a_sample_has_the_sign_and_scale_of_the_url() -> None:
    sensor = heard((0.001, 5.0, 1.0))
    ForceSensor._take(sensor, 0.002, {"status": constant("LOAD_CELL"), "measured_n": 3.0})
    assert sensor._samples[-3] == 0.002 and sensor._samples[-1] == -6.0


@pytest.mark.parametrize(
    ("stamp_s", "status", "words"),
    [(0.001, constant("LOAD_CELL"), "it restarted: start again"), (0.002, 0, "carry no force")],
)
def test_what_ends_a_sensor_is_said(stamp_s: float, status: int, words: str) -> None:
    with pytest.raises(DeviceError, match=words):
        ForceSensor._take(heard((0.001, 5.0, 1.0)), stamp_s, {"status": status, "measured_n": 3.0})


def test_a_sensor_that_falls_silent_ends_the_press() -> None:
    sensor: Any = SimpleNamespace(url="serial:///dev/x", error=None)
    arguments = ("dhd://", "pad", Limits(), lambda _progress: None)
    device = SensedPressDevice(*arguments, sensor=sensor)
    assert "serial:///dev/x: silent for 100 ms" in str(device.unmeasured())
    sensor.error = DeviceError("unplugged")
    assert str(device.unmeasured()) == "unplugged"


def test_a_serial_device_without_a_load_cell() -> None:
    with (
        peer("serial_device") as device,
        pytest.raises(DeviceError, match="carry no force"),
        opened_sensor(device.url),
    ):
        pass


def test_a_load_cell_on_a_serial_line() -> None:
    with peer("dhd_device", "--cell-ms", 5) as device:
        sensor = ForceSensor(device.wait_for("cell")["url"] + "&n_per_unit=2")
        sensor.require_rate()
        time.sleep(0.3)
        times_s, forces_n = sensor.samples()
        sensor.close()
    assert len(times_s) > 300 and np.diff(times_s) == pytest.approx(1e-3, rel=0.05)
    assert np.std(forces_n) == pytest.approx(0.02, rel=0.3)
