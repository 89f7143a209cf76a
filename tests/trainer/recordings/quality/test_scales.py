"""A recording in another unit of force than its set is named; other speeds and depths are not."""

import numpy as np
import pytest
from support.files.recording_files import PressedObject, motion

from springpot.trainer.recordings.quality.scales import scale_findings
from springpot.trainer.recordings.recording import Recording


def presses(seed: int) -> list[Recording]:
    """Of one object: three presses of other depths and speeds; the first may soften it."""
    rng = np.random.default_rng(seed)
    law = PressedObject(8e-3, 20.0, rng.uniform(1.0, 2.4), rng.uniform(0.0, 0.7))
    found = []
    for name in "abc":
        depth_m, seconds = rng.uniform(0.4, 1.0) * 8e-3, 10.0 ** rng.uniform(0.0, 2.0)
        position_m = motion(
            str(rng.choice(["cycles", "hold", "ramp"])), depth_m, 400 / seconds, seconds
        )
        force_n = rng.uniform(0.7, 1.0) * law.force(position_m, seconds / 400)
        force_n += rng.normal(0.0, 0.02, len(force_n))
        found.append(Recording(name, position_m, force_n, seconds / 400))
    return found


@pytest.mark.parametrize("seed", range(20))
def test_one_object_has_one_scale(seed: int) -> None:
    assert list(scale_findings(presses(seed))) == []


@pytest.mark.parametrize("unit_n", [9.807, 9.807e-3, 1e3, 1e-3])
@pytest.mark.parametrize("seed", range(4))
def test_another_unit_is_named(seed: int, unit_n: float) -> None:
    recordings = presses(seed)
    odd = recordings[seed % 3]
    recordings[seed % 3] = Recording("odd", odd.position_m, odd.force_n / unit_n, odd.dt_s)
    assert [found.where for found in scale_findings(recordings)] == ["odd"]


@pytest.mark.parametrize("seed", range(6))
def test_a_fluid_may_push_in_proportion_to_speed(seed: int) -> None:
    recordings = []
    for factor in (1.0, 4.0, 16.0):
        time_s = np.linspace(0.0, 4.0, 800) / factor
        position_m = 4e-3 * (1.0 - np.cos(2.0 * np.pi * np.linspace(0.0, 2.0, 800)))
        force_n = 50.0 * np.gradient(position_m, time_s) + 0.1 * position_m / 8e-3
        force_n += np.random.default_rng(seed).normal(0.0, 1e-3, 800)
        recordings.append(Recording(str(factor), position_m, force_n, 5e-3 / factor))
    assert list(scale_findings(recordings)) == []
