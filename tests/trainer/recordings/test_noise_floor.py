"""The noise floor: from repeats, from cycles, from the sensor; never below what the object does."""

from dataclasses import replace

import numpy as np
import pytest
from support.small import DT_S, press, recording

from springpot.trainer.recordings.quality.repeats import find_noise_floor
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import sensor_noise_n

FIRST = recording("press", press(0.5))


def normal(sd: float, seed: int, samples: int = len(FIRST.force_n)) -> np.ndarray:
    return np.random.default_rng(seed).normal(0, sd, samples)


def repeats(count: int, sd_n: float) -> list[Recording]:
    return [
        replace(FIRST, name=f"r{k}", force_n=FIRST.force_n + normal(sd_n, k)) for k in range(count)
    ]


@pytest.mark.parametrize("count", [2, 3, 8])
def test_noise_alone_gives_its_own_rms(count: int) -> None:
    found = find_noise_floor(repeats(count, 0.05))
    assert found.rms_n == pytest.approx(0.05, rel=0.05)
    assert (found.source, found.words) == ("repeats", f"from {count} repeats of one press")


def test_a_softer_object_under_the_same_force_is_no_explanation_of_itself() -> None:
    """The second press goes 6 % deeper: at equal depth its force differs by that much stiffness."""
    depth_m = np.maximum(press(0.5), 0.0)
    force_n = 500.0 * depth_m
    presses = [
        Recording(f"p{k}", depth_m * (1 + 0.06 * k), force_n + normal(0.002, k), DT_S)
        for k in range(2)
    ]
    found = find_noise_floor(presses)
    # Half the difference stands for each of two, and their mean depth is 3 % deeper.
    expected_n = 0.06 / 1.03 * float(np.sqrt(np.mean(force_n**2))) / np.sqrt(2)
    assert found.source == "repeats"
    assert found.rms_n == pytest.approx(expected_n, rel=0.03)


def test_cycles_stand_in_for_repeats() -> None:
    cycles = recording("cycles", press(2.0, cycles=8))
    noisy = replace(cycles, force_n=cycles.force_n + normal(0.05, 0, len(cycles.force_n)))
    found = find_noise_floor([noisy])
    assert (found.source, found.rms_n) == ("cycles", pytest.approx(0.05, rel=0.1))
    assert found.words == "from the repeated cycles within one recording"


@pytest.mark.parametrize("held", [1, 10])
def test_the_sensor_is_seen_through_the_press(held: int) -> None:
    """Also where it is slower than the recording, and holds its value."""
    force_n = FIRST.force_n + normal(0.03, 0)
    slow_n = np.repeat(force_n[::held], held)[: len(force_n)]
    assert 0.02 < sensor_noise_n(slow_n) < 0.06


def test_no_noise_is_said_not_divided_by() -> None:
    found = find_noise_floor([FIRST])
    assert (found.rms_n, found.source) == (None, None)
    assert found.words == "no press is repeated, and the force shows no noise"
    assert find_noise_floor([]).rms_n is None
    still = Recording("still", np.zeros(100), np.full(100, 3.0), DT_S)
    assert find_noise_floor([still, replace(still, name="again")]).rms_n is None


def test_an_object_that_settles_within_its_cycles_is_no_noise() -> None:
    """A model with a memory predicts how the cycles' mean and height settle."""
    cycles = recording("cycles", press(2.0, cycles=20))
    left = np.exp(-np.arange(len(cycles.force_n)) * DT_S / 2.0)
    settling_n = cycles.force_n * (1.0 + 0.1 * left) + normal(0.01, 0, len(left))
    found = find_noise_floor([replace(cycles, force_n=settling_n)])
    assert found.source == "cycles"
    assert 0.009 < found.rms_n < 0.03


def test_repeats_of_one_session_are_no_noise() -> None:
    noisy = repeats(4, 0.05)
    timed = [replace(each, session="s", start_s=10.0 * k) for k, each in enumerate(noisy)]
    assert find_noise_floor(noisy).source == "repeats"
    assert find_noise_floor(timed).source != "repeats"
    apart = [replace(each, session=f"{k}") for k, each in enumerate(timed)]
    assert find_noise_floor(apart).source == "repeats"
