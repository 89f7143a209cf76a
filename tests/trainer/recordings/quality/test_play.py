"""Play between tool and sensor is said; a hold, a rest and a coarse sensor are none."""

import numpy as np
import pytest
from support.files.recording_files import PressedObject, motion

from springpot.trainer.recordings.quality.sensors.play import play_findings
from springpot.trainer.recordings.recording import Recording


def recorded(seed: int, play: float, kind: str = "cycles") -> Recording:
    """A press of an object of any size and law; play: of the stroke."""
    rng = np.random.default_rng(seed)
    stroke_m, rate_hz = 10.0 ** rng.uniform(-3.3, -1.9), float(rng.choice([50.0, 100.0]))
    law = PressedObject(stroke_m, 10.0, rng.uniform(1.0, 2.4), rng.uniform(0.0, 0.7))
    tool_m = motion(kind, stroke_m, rate_hz, rng.uniform(6.0, 20.0))
    force_n = law.force(tool_m, 1.0 / rate_hz) + rng.normal(0.0, 0.02, len(tool_m))
    sensed_m = tool_m.copy()
    for k in range(1, len(tool_m)):
        sensed_m[k] = min(max(sensed_m[k - 1], tool_m[k] - play * stroke_m), tool_m[k])
    grain_m = stroke_m / rng.choice([300.0 if play else 30.0, 1e3, 1e6])
    return Recording("a", np.round(sensed_m / grain_m) * grain_m, force_n, 1.0 / rate_hz)


@pytest.mark.parametrize("seed", range(6))
def test_play_is_said(seed: int) -> None:
    play = np.random.default_rng(seed).uniform(0.15, 0.3)
    (found,) = play_findings(recorded(seed, play))
    assert "play" in found.so_what


@pytest.mark.parametrize("kind", ["cycles", "hold", "ramp"])
@pytest.mark.parametrize("seed", range(6))
def test_without_play_nothing_is_said(seed: int, kind: str) -> None:
    assert list(play_findings(recorded(seed, 0.0, kind))) == []
