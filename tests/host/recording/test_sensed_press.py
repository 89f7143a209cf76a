"""A press with a sensor beside the device: rows of one moment, a control that bears any delay."""

from collections import deque
from types import SimpleNamespace

import numpy as np
import pytest

from springpot.codegen.errors import DeviceError, UsageError
from springpot.host.native.loop_library import COLUMN, empty_rows, loop_library
from springpot.host.recording import sensed_press
from springpot.host.recording.indentation import OPEN_LOOP, Limits, press_step_functions
from springpot.host.recording.sensed_press import SensedPressDevice, _SensedRows
from springpot.host.recording.session import open_press_device
from springpot.host.simulation.bench import ObjectMotion
from springpot.host.simulation.objects import SimulatedObject

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
    rows = _SensedRows(300, lambda x, f: kept.append((x, f)), 0, sensor, LATE_S, lambda: START_S)
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
    rows = _SensedRows(300, lambda _x, _f: None, 0, sensor, LATE_S, lambda: START_S)
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
        open_press_device("sim://ecoflex-00-30", sensor=SimpleNamespace())


@pytest.mark.parametrize("late_ms", [1, 20])
@pytest.mark.parametrize("name", ["ecoflex-00-30", "dragon-skin-10"])
def test_the_control_is_stable_and_better_than_none(name: str, late_ms: int) -> None:
    """A held force against the friction of the device: the sum of errors takes it away."""
    left_n = {}
    for gains in (OPEN_LOOP, sensed_press._GAINS):
        force_n = held_force(name, late_ms, gains)
        left_n[bool(gains.get("i_gain_per_s"))] = np.abs(force_n[-500:] - 3.0).mean()
        assert np.ptp(force_n[-500:]) < 0.05
    assert left_n[False] > 0.2
    assert left_n[True] < 0.1


def held_force(name: str, late_ms: int, gains: dict[str, float]) -> np.ndarray:
    """4 s of a command that rises to 3 N, on a tool of 0.3 kg with friction of 0.3 N."""
    command_n = 3.0 * np.minimum(1.0, np.arange(4000) / 1000)
    steps = press_step_functions(command_n, 6.0, gains)
    press, _ = steps.kept
    c, ffi = loop_library("double").c, loop_library("double").ffi
    out, substeps = ffi.new("double *"), 8
    held, h = ObjectMotion(SimulatedObject(name), 1e-3 / substeps), 1e-3 / substeps
    at_m, speed_mps, late = np.zeros(1), 0.0, deque([0.0] * late_ms)
    force_n = np.zeros(4000)
    for tick in range(4000):
        press.measured_n = late.popleft()
        c.sp_press_step(press, at_m[0], speed_mps, out)
        for _ in range(substeps):
            object_n = float(held.move(at_m)[0])
            push_n = -out[0] - object_n - 4.0 * speed_mps
            if abs(speed_mps) < 1e-4 and abs(push_n) <= 0.3:
                speed_mps = 0.0
            else:
                way = np.sign(speed_mps if abs(speed_mps) > 1e-9 else push_n)
                speed_mps += h * (push_n - 0.3 * way) / 0.3
            at_m[0] += h * speed_mps
        force_n[tick] = object_n
        late.append(object_n)
    return force_n
