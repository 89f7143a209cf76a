"""A press with a sensor beside the device: rows of one moment."""

from types import SimpleNamespace

import numpy as np
import pytest

from springpot.codegen.errors import DeviceError, UsageError
from springpot.host.native.loop_library import COLUMN, empty_rows
from springpot.host.recording.indentation import Limits
from springpot.host.recording.session import open_press_device
from springpot.host.wings.lab.force_sensor.sensed_press import SensedPressDevice, _SensedRows

LATE_S, START_S = 0.012, 500.0


class Sensor:
    """Measures its own time, late; `now_s`: up to when samples have come."""

    url, error = "can://x", None

    def __init__(self) -> None:
        self.now_s = START_S

    def forget(self) -> None:
        pass

    def samples(self):
        sensor_s = np.arange(START_S - 0.05, self.now_s, 1e-3)
        return sensor_s, sensor_s - START_S - LATE_S


def rows_from(first: int, count: int) -> np.ndarray:
    rows = empty_rows(count)
    rows[:, COLUMN["time_s"]] = 1e-3 * np.arange(first, first + count)
    rows[:, COLUMN["position_m"]] = 1e-6 * np.arange(first, first + count)
    return rows


def test_rows_wait_for_the_force_of_their_moment() -> None:
    sensor, kept = Sensor(), []
    rows = _SensedRows(300, lambda x, f: kept.append((x, f)), sensor, LATE_S, lambda: START_S)
    for first in range(0, 400, 50):
        sensor.now_s = START_S + 1e-3 * (first + 50)
        rows.append(rows_from(first, 50))
        assert len(rows.position_m) <= max(0, first + 50 - 11)
    assert rows.full
    force_n = np.concatenate([force_n for _, force_n in kept])
    assert force_n == pytest.approx(1e-3 * np.arange(300), abs=1e-9)
    assert np.concatenate([x for x, _ in kept]) == pytest.approx(1e-6 * np.arange(300))


def test_a_sensor_that_falls_silent_ends_the_press() -> None:
    sensor = Sensor()
    rows = _SensedRows(300, lambda _x, _f: None, sensor, LATE_S, lambda: START_S)
    silent = rows_from(0, 40)
    silent[:, COLUMN["measured_n"]] = np.nan
    rows.append(silent)
    assert not rows.unmeasured  # none has come yet
    silent = rows_from(40, 40)
    silent[-1, COLUMN["measured_n"]] = np.nan
    rows.append(silent)
    assert rows.unmeasured
    device = SensedPressDevice("dhd://", "pad", Limits(), lambda _progress: None, sensor)
    assert "silent for 100 ms" in str(device.unmeasured())
    sensor.error = DeviceError("unplugged")
    assert str(device.unmeasured()) == "unplugged"


def test_a_simulated_bench_takes_no_sensor() -> None:
    with pytest.raises(UsageError, match="leave --force out"):
        open_press_device("sim://ecoflex-00-30", pressing=SimpleNamespace)
