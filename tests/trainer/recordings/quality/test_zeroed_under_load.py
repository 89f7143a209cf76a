"""Force zeroed while the tool pressed shows in the air, below 0; what pulls the tool does not."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from support.files.recording_files import PressedObject

from springpot import Recording, check_recordings
from springpot.trainer.recordings.quality.contact.surface import contact_findings
from springpot.trainer.recordings.quality.contact.zeroed_under_load import find_air_level

RATE_HZ = 500.0
TIME_S = np.arange(0.0, 8.0, 1.0 / RATE_HZ)


def motion(draw: np.random.Generator, depth_m: float, low: float) -> np.ndarray:
    """Sines or triangles between `low`, of the depth, and the depth, at some frequency."""
    hz = draw.uniform(0.3, 2.0)
    wave = 0.5 * (1.0 - np.cos(2.0 * np.pi * hz * TIME_S))
    if draw.uniform() < 0.5:
        wave = np.arccos(np.cos(2.0 * np.pi * hz * TIME_S)) / np.pi
    return depth_m * (low + (1.0 - low) * wave)


def left_object(seed: int) -> tuple[Recording, float]:
    """A dented object that the tool leaves on its way out, and the force that was taken off."""
    draw = np.random.default_rng(seed)
    depth_m = 10.0 ** draw.uniform(-3.0, -2.0)
    position_m = motion(draw, depth_m, -draw.uniform(0.06, 0.2))
    law = PressedObject(depth_m, 6.0, draw.uniform(1.0, 2.2), draw.uniform(0.1, 0.5))
    force_n = law.force(position_m, 1.0 / RATE_HZ)
    force_n += force_n.max() * 10.0 ** draw.uniform(-4.0, -2.3) * draw.normal(size=len(force_n))
    taken_n = draw.uniform(0.05, 0.5) * float(force_n.max())
    begin = int(np.argmax(force_n >= taken_n))  # where the rig takes its zero
    position_m, force_n = position_m[begin:], force_n[begin:]
    zeroed = Recording(f"{seed:02}", position_m - position_m[0], force_n - taken_n, 1.0 / RATE_HZ)
    return zeroed, taken_n


@pytest.mark.parametrize("seed", range(40))
def test_the_level_in_the_air_is_the_force_that_was_taken_off(seed: int) -> None:
    recording, taken_n = left_object(seed)
    level = find_air_level(recording)
    assert level is not None
    assert level.force_n == pytest.approx(-taken_n, abs=0.01 * float(recording.force_n.max()))


@pytest.mark.parametrize("seed", range(20))
def test_its_remedy_leaves_no_such_line(seed: int) -> None:
    """Where the air is not at the lowest positions, as an object that recovers late has it."""
    recording, _ = left_object(seed)
    said = [found for found in contact_findings([recording]) if found.kind == "tare"]
    assert len(said) == 1
    stated = re.fullmatch(r"import with --tare=(-[\d.]+)", said[0].to_do)
    if stated is None:  # all of the way in is in the air first: import finds it
        assert said[0].to_do == "import with --tare auto"
        return
    tared = replace(recording, force_n=recording.force_n - float(stated[1]))
    assert find_air_level(tared) is None
    assert not [found for found in contact_findings([tared]) if found.kind == "tare"]


def test_a_coarse_sensor_in_the_air_is_not_called_clipped_alone() -> None:
    """Its air is one value, as a sensor's limit is: both are named, each with its remedy."""
    named = 0
    for seed in range(20):
        recording, _ = left_object(seed)
        step_n = 0.02 * float(np.ptp(recording.force_n))
        coarse = replace(recording, force_n=np.round(recording.force_n / step_n) * step_n)
        for found in check_recordings([coarse]).findings:
            if found.kind == "clipping":
                assert f"--tare={coarse.force_n.min():.6g}" in found.to_do
                named += 1
    assert named >= 10


def bonded(draw: np.random.Generator, position_m: np.ndarray) -> np.ndarray:
    return 2e3 * position_m * (1.0 + draw.uniform(0.0, 1.0) * np.abs(position_m) / 4e-3)


def plastic(draw: np.random.Generator, position_m: np.ndarray) -> np.ndarray:
    """It yields when it is pulled and when it is pressed: level both ways, at opposite forces."""
    limit_n, force_n = draw.uniform(1.0, 3.0), np.zeros_like(position_m)
    for i, step_m in enumerate(np.diff(position_m)):
        force_n[i + 1] = np.clip(force_n[i] + 4e3 * step_m, -limit_n, 2.0 * limit_n)
    return force_n


def preload(draw: np.random.Generator, position_m: np.ndarray) -> np.ndarray:
    """Zeroed under load and never left: at its turns force is nearly level, and is no air."""
    law = PressedObject(8e-3, 20.0, draw.uniform(1.0, 2.5), draw.uniform(0.0, 0.15))
    deep_m = position_m - position_m.min() + draw.uniform(4e-3, 8e-3)
    way_in_m = np.linspace(0.0, deep_m[0], 200)
    force_n = law.force(np.concatenate([way_in_m, deep_m]), 1.0 / RATE_HZ)[200:]
    assert force_n.min() > 0.0
    return force_n - draw.uniform(0.5, 1.0) * force_n[0]


def damper(draw: np.random.Generator, position_m: np.ndarray) -> np.ndarray:
    return draw.uniform(50.0, 500.0) * np.gradient(position_m) * RATE_HZ


def fluid(draw: np.random.Generator, position_m: np.ndarray) -> np.ndarray:
    """A spring and a damper in a row, bonded: of a triangle it is level at the end of each way."""
    force_n, keep = np.zeros_like(position_m), np.exp(-1.0 / RATE_HZ / draw.uniform(0.02, 0.5))
    for i, step_m in enumerate(np.diff(position_m)):
        force_n[i + 1] = keep * force_n[i] + 2e3 * step_m
    return force_n


def mass(draw: np.random.Generator, position_m: np.ndarray) -> np.ndarray:
    acceleration = np.gradient(np.gradient(position_m)) * RATE_HZ**2
    pushes_n = 2e3 * np.maximum(position_m, 0.0)
    return pushes_n + draw.uniform(0.1, 2.0) * acceleration


def friction(draw: np.random.Generator, position_m: np.ndarray) -> np.ndarray:
    """Of a guide: the tool is in the air at the lowest positions."""
    pushes_n = 2e3 * np.maximum(position_m, 0.0)
    return pushes_n + draw.uniform(0.3, 1.0) * np.sign(np.gradient(position_m))


def sticky(draw: np.random.Generator, position_m: np.ndarray) -> np.ndarray:
    """It holds the tool up to a pull-off force, zeroed in the air."""
    force_n, touching, off_m = np.zeros_like(position_m), False, -draw.uniform(2e-4, 6e-4)
    for i, x_m in enumerate(position_m.tolist()):
        touching = x_m > 0.0 or (touching and x_m > off_m)
        force_n[i] = 3e3 * x_m if touching else 0.0
    return force_n


def clipped(draw: np.random.Generator, position_m: np.ndarray) -> np.ndarray:
    return np.maximum(2e3 * position_m, -draw.uniform(0.5, 1.5))


OBJECTS = [bonded, plastic, preload, damper, fluid, mass, friction, sticky, clipped]


@pytest.mark.parametrize("law", OBJECTS)
def test_what_pulls_the_tool_was_not_zeroed_under_load(
    law: Callable[[np.random.Generator, np.ndarray], np.ndarray],
) -> None:
    for seed in range(40):
        draw = np.random.default_rng(seed)
        every = int(draw.choice([1, 2, 5, 10]))  # samples: presses of up to 20 Hz
        position_m = motion(draw, 4e-3, -draw.uniform(0.2, 1.0))[::every]
        force_n = law(draw, position_m)
        if law is not clipped:
            noise = 10.0 ** draw.uniform(-4.0, -2.0) * float(np.ptp(force_n))
            force_n = force_n + noise * draw.normal(size=len(force_n))
        assert find_air_level(Recording(f"{seed:02}", position_m, force_n, 1.0 / RATE_HZ)) is None
