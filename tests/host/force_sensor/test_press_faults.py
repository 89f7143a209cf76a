"""What ends a press: a tool that runs away, a sensor that is wrong, a control that rings; and no
press of a known object."""

from itertools import product
from typing import Any

import numpy as np
import pytest
from support.c.pressed_tool import PressedTool

from springpot.host.recording.indentation import _GAINS, OPEN_LOOP, PressedDevice
from springpot.host.recording.protocols import extended, inverted_cosine, training, validation
from springpot.host.recording.sensed_press import SensedPressDevice, alignment_command
from springpot.host.simulation.objects import ALL_OBJECTS

FAST, UNLIKE, RINGS = 1, 2, 3
TABLE_NPM = 1e5
# Control by a sensor that is the device's own, and by one beside it that is late.
PD = {"gains": dict(_GAINS), "sensor_s": 0.0, "max_mps": PressedDevice.max_mps}
LATE = {"sensor_s": 0.005, "max_mps": SensedPressDevice.max_mps}
SLOW = inverted_cosine(np.arange(5000) / 1000, 8.0, 0.2)
HELD = inverted_cosine(np.minimum(np.arange(2500) / 1000, 0.5), 8.0, 1.0)
WRONG: dict[str, dict[str, float]] = {
    "shows a quarter": {"sensor_gain": 0.25},
    "shows nothing": {"sensor_gain": 0.0},
    "is turned": {"sensor_gain": -1.0},
    "shows four times as much": {"sensor_gain": 4.0},
    "is stuck": {"sensor_holds": 1},
}


def require_no_fault(tool: PressedTool, commands_n: list[np.ndarray]) -> None:
    for command_n in commands_n:
        assert tool.press(command_n).fault == 0, (tool, len(command_n))


@pytest.mark.few(4)
@pytest.mark.parametrize("control", [PD, LATE], ids=["pd", "late"])
@pytest.mark.parametrize("name", ALL_OBJECTS)
def test_no_press_of_the_paper_is_refused(name: str, control: dict[str, Any]) -> None:
    require_no_fault(PressedTool(name=name, **control), [one.command_n for one in training()])


@pytest.mark.few(0, 10)
@pytest.mark.parametrize("name", ALL_OBJECTS)
@pytest.mark.parametrize(
    ("sensor_s", "viscous_nspm", "coulomb_n"),
    [(0.0, 4.0, 0.3), (0.005, 2.0, 0.1), (0.02, 2.0, 0.1)],
)
def test_no_press_of_a_protocol_is_refused(
    name: str, sensor_s: float, viscous_nspm: float, coulomb_n: float
) -> None:
    commands_n = [one.command_n for one in (*extended(0), *validation(1))]
    device = {"name": name, "viscous_nspm": viscous_nspm, "coulomb_n": coulomb_n}
    require_no_fault(PressedTool(**device, **LATE | {"sensor_s": sensor_s}), commands_n)
    if sensor_s == 0.0:
        require_no_fault(PressedTool(**device, **PD), commands_n)
    chirp = PressedTool(**device, **LATE | {"sensor_s": sensor_s}, gains=dict(OPEN_LOOP))
    assert chirp.press(alignment_command()).fault == 0


@pytest.mark.parametrize("control", [PD, LATE], ids=["pd", "late"])
@pytest.mark.parametrize("above_m", [0.005, 0.01, 0.02, 0.03, 0.05, 0.1])
def test_a_tool_that_loses_its_object_meets_the_table_at_the_limit_at_most(
    control: dict[str, Any], above_m: float
) -> None:
    """Pressed with 3 to 8 N; the table is like wood. From 5 cm on it is stopped in the air."""
    at_limit_n = control["max_mps"] * np.sqrt(TABLE_NPM * PressedTool().mass_kg)
    for lost_tick in (200, 400, 600, 1000, 2000):
        at_m = PressedTool(**control).press(HELD).position_m[lost_tick]
        lost = {"lost_tick": lost_tick, "table_m": float(at_m) + above_m, "table_npm": TABLE_NPM}
        pressed = PressedTool(**control, goes_wrong=lost).press(HELD)
        assert pressed.force_n[lost_tick:].max() < 1.25 * at_limit_n, lost_tick
        assert pressed.motor_n[-1] == 0.0 or not pressed.fault
        if above_m >= 0.05:
            assert pressed.fault in (FAST, UNLIKE) and pressed.force_n[lost_tick:].max() == 0.0


@pytest.mark.few(20, 50)
@pytest.mark.parametrize("control", [PD, LATE], ids=["pd", "late"])
@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("name", ALL_OBJECTS)
def test_a_sensor_that_goes_wrong_ends_the_press(
    name: str, wrong: str, control: dict[str, Any]
) -> None:
    for tick in (1, 1500, 3000):
        goes_wrong = {"wrong_tick": tick, **WRONG[wrong]}
        pressed = PressedTool(name=name, **control, goes_wrong=goes_wrong).press(SLOW)
        assert pressed.fault != 0, tick
        assert pressed.motor_n[-1] == 0.0


def test_a_control_that_rings_ends_the_press() -> None:
    """Whatever the set-up: of those that shake the tool for the last half second, none goes on."""
    shaken, missed = 0, []
    for mass_kg, spring_npm, late_s, motor_s in product(
        (0.05, 0.1, 0.3, 1.0), (300.0, 1e3, 3e3, 1e4, 3e4), (0.0, 0.002, 0.005), (0.0005, 0.002)
    ):
        case = {"mass_kg": mass_kg, "spring_npm": spring_npm, "sensor_s": late_s,
                "motor_s": motor_s, "gains": dict(_GAINS)}  # fmt: skip
        speed_mps = np.diff(PressedTool(**case).press(HELD).position_m[-500:]) * 1000
        if np.sqrt(np.mean(speed_mps**2)) > 0.04:
            shaken += 1
            if PressedTool(**case, max_mps=PressedDevice.max_mps).press(HELD).fault == 0:
                missed.append(case)
    assert shaken > 40 and missed == []
