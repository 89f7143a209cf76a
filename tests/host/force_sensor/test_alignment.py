"""A late force sensor is found by the motion of the tool, or one line says what is wrong."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from support.c.pressed_tool import PressedTool

from springpot.codegen.errors import DeviceError
from springpot.host.recording.indentation import OPEN_LOOP
from springpot.host.recording.sensed_press import Delay, alignment_command, find_delay


@dataclass(frozen=True)
class Motion:
    """Times, positions and forces of the motor, and the sensor's times and forces."""

    t_s: np.ndarray
    position_m: np.ndarray
    motor_n: np.ndarray
    sensor_s: np.ndarray
    sensor_n: np.ndarray

    def delay(self) -> Delay:
        motion, sensor = (self.t_s, self.position_m, self.motor_n), (self.sensor_s, self.sensor_n)
        return find_delay(motion, sensor, "sensor")


def pressed(name: str, late_s: float, seed: int = 0, sign: float = 1.0, **tool: Any) -> Motion:
    """A tool that a chirp presses into an object; friction, encoder steps, a noisy sensor."""
    draw = np.random.default_rng(seed)
    command_n = np.concatenate([np.zeros(100), alignment_command(), np.zeros(150)])
    made = PressedTool(name=name, gains=dict(OPEN_LOOP), **tool).press(command_n)
    t_s = np.arange(len(command_n)) * 1e-3
    sensor_s = t_s + draw.uniform(0, 1e-3)
    felt_n = np.interp(sensor_s - late_s, t_s, made.force_n) + 0.015 * draw.normal(size=len(t_s))
    return Motion(t_s, made.seen_m, command_n, sensor_s, sign * felt_n)


@pytest.mark.parametrize("devices", [4, pytest.param(20, marks=pytest.mark.slow)])
def test_the_delay_is_found(devices: int) -> None:
    """Within a third of a sample."""
    draw = np.random.default_rng(21)
    names = ("ecoflex-00-30", "ecoflex-00-50", "dragon-skin-10", "bergstrom-boyce")
    for seed in range(devices):
        late_s, mass_kg = draw.uniform(1e-3, 20e-3), np.exp(draw.uniform(np.log(0.1), np.log(0.8)))
        motion = pressed(
            names[seed % 4], late_s, seed, mass_kg=mass_kg, coulomb_n=draw.uniform(0, 0.3),
            motor_s=draw.uniform(0, 3e-3),
        )  # fmt: skip
        found = motion.delay()
        assert abs(found.value_s - late_s) < 0.3e-3
        assert found.mass_kg == pytest.approx(mass_kg, rel=0.1)


def test_a_sensor_of_the_wrong_sign() -> None:
    with pytest.raises(DeviceError, match="turn its sign, &n_per_unit=-1"):
        pressed("ecoflex-00-30", 5e-3, sign=-1.0).delay()


def test_a_force_that_is_not_the_tool_s() -> None:
    motion = pressed("ecoflex-00-30", 5e-3)
    other = np.random.default_rng(3).normal(size=len(motion.sensor_n))
    moved = replace(motion, sensor_n=motion.sensor_n + np.convolve(other, np.ones(30), "same"))
    with pytest.raises(DeviceError, match="does not fit the tool's motion"):
        moved.delay()


def test_ticks_that_are_made_up_for_at_once() -> None:
    """A busy computer: now and then ten ticks come at one time, with one force."""
    motion = pressed("ecoflex-00-30", 5e-3)
    t_s, motor_n = motion.t_s.copy(), motion.motor_n.copy()
    position_m = motion.position_m.copy()
    for late in range(300, len(t_s) - 300, 90):
        t_s[late : late + 10] = t_s[late + 9] + 1e-7 * np.arange(10)
        position_m[late : late + 10] = position_m[late + 9]
    found = replace(motion, t_s=t_s, position_m=position_m, motor_n=motor_n).delay()
    assert abs(found.value_s - 5e-3) < 1e-3
