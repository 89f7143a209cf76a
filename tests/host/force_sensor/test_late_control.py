"""A late force sensor: found by the tool's motion, and force control by it, whatever is pressed."""

from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from support.c.pressed_tool import PressedTool

from springpot.codegen.errors import DeviceError
from springpot.host.recording.indentation import OPEN_LOOP, press_step_functions
from springpot.host.recording.protocols import inverted_cosine, training
from springpot.host.recording.sensed_press import Delay, alignment_command, find_delay, late_gains

HELD = inverted_cosine(np.minimum(np.arange(2000) / 1000, 0.2), 1.0, 2.5)
FAST = inverted_cosine(np.arange(200) / 1000, 1.0, 5.0)
PEAK = 1.4  # `record` stops beyond 1.7


@pytest.mark.parametrize(
    ("name", "mean_rms", "peak"),
    [("ecoflex-00-30", 0.16, 1.16), ("bergstrom-boyce", 0.06, 1.06),
     ("stiffening-tissue", 0.11, 1.6)],
)  # fmt: skip
@pytest.mark.parametrize("late_s", [0.003, 0.02])
def test_the_paper_s_presses(name: str, mean_rms: float, peak: float, late_s: float) -> None:
    tool = PressedTool(name=name, sensor_s=late_s)
    presses = [tool.press(profile.command_n) for profile in training()]
    assert max(press.peak for press in presses) < peak
    assert np.mean([press.rms for press in presses]) < mean_rms


def grid() -> list[dict[str, Any]]:
    """Springs from soft to stiff with little damping, a slit of air, tissue that stiffens."""
    springs: list[dict[str, Any]] = [{"spring_npm": k} for k in (10.0, 100.0, 1000.0, 5000.0)]
    stiff = {"spring_npm": 5000.0}
    others = {**stiff, "gap_m": 0.5e-3}, {**stiff, "damper_nspm": 20.0}
    return [*springs, *others, {"name": "stiffening-tissue"}]


@pytest.mark.parametrize("pressed", grid(), ids=str)
def test_stable_on_soft_and_stiff(pressed: dict[str, Any]) -> None:
    """Light and heavy tools, without friction and with, of which the mass is known badly."""
    amplitude_n = min(10.0, 0.02 * pressed.get("spring_npm", 1e3))
    for mass_kg, sensor_s, motor_s, (viscous_nspm, wrong) in product(
        (0.1, 0.8), (0.0, 0.02), (0.0, 0.002), ((0.3, 0.8), (0.3, 1.2), (4.0, 1.0))
    ):
        tool = PressedTool(mass_kg, sensor_s, motor_s, viscous_nspm, 0.0, wrong, **pressed)
        held = tool.press(amplitude_n * HELD)
        case = (mass_kg, sensor_s, motor_s, viscous_nspm, wrong)
        fast = tool.press(amplitude_n * FAST)
        assert max(press.peak for press in (held, fast)) < PEAK, case
        assert np.ptp(held.force_n[-400:]) < 0.1 * amplitude_n, case
        if amplitude_n >= 10.0:  # softer ones are still on their way
            assert abs(held.force_n[-400:].mean() / amplitude_n - 1) < 0.025, case


@pytest.mark.parametrize("sensor_s", [0.0, 0.02])
def test_a_late_motor_on_a_stiff_object(sensor_s: float) -> None:
    for mass_kg, wrong in product((0.1, 0.8), (0.8, 1.2)):
        tool = PressedTool(mass_kg, sensor_s, 0.004, 0.3, 0.0, wrong, spring_npm=5000.0)
        held = tool.press(10.0 * HELD)
        assert held.peak < 1.1 and np.ptp(held.force_n[-400:]) < 0.3


@pytest.mark.parametrize("late_s", [0.001, 0.02])
def test_friction_is_given_to_the_motor_too(late_s: float) -> None:
    left_n = {}
    for gains in ({}, dict(OPEN_LOOP)):
        tool = PressedTool(sensor_s=late_s, coulomb_n=0.3, gains=gains)
        force_n = tool.press(3.0 * HELD).force_n
        left_n[bool(gains)] = abs(force_n[-500:].mean() - 3.0)
    assert left_n[True] > 0.2 and left_n[False] < 0.05


def test_a_tick_without_a_sample_goes_on() -> None:
    gains = late_gains(Delay(0.01, 0.001, 0.3))
    steps = press_step_functions(np.full(1000, 3.0), 6.0, gains)
    press, _ = steps.owners
    c, out = steps.library.c, steps.library.ffi.new("double *")
    for _ in range(500):  # at rest, 3 N of motor are 2.5 N on the sensor
        press.measured_n = -0.5 - out[0]
        c.sp_press_step(press, 0.004, 0.0, out)
    assert out[0] == pytest.approx(-3.5, abs=0.01)
    c.sp_press_idle(press, 1e-3, out)
    assert out[0] == pytest.approx(-3.5, abs=0.01)
    c.sp_press_reset(press)
    c.sp_press_idle(press, 1e-3, out)
    assert out[0] == -3.0


@pytest.mark.parametrize("position_m", [np.nan, np.inf, 1e308, -1e308])
@pytest.mark.parametrize("observed", [True, False])
def test_a_position_that_cannot_be_ends_in_no_force(position_m: float, observed: bool) -> None:
    gains = late_gains(Delay(0.01, 0.001, 0.3)) if observed else OPEN_LOOP
    steps = press_step_functions(np.full(1000, 3.0), 6.0, gains)
    press, _ = steps.owners
    c, out = steps.library.c, steps.library.ffi.new("double *")
    for _ in range(300):
        c.sp_press_step(press, 0.004, 0.0, out)
    for k in range(30):
        c.sp_press_step(press, position_m, 0.0, out)
        assert abs(out[0]) <= 6.0
        assert np.isfinite(position_m) or out[0] <= 0.0, k  # never out of the object
        assert press.at == 301 + k
    if observed or not np.isfinite(position_m):
        assert press.latched and out[0] == 0.0


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
