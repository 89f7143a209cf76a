"""Hours of samples: what a fit holds grows by a few numbers a sample."""

import tracemalloc

import numpy as np
import pytest
from support.small import DT_S, press, recording

from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording import Recording

NUMBERS = 8  # a sample, beside its position and force: ten hours at 1 kHz are then 2.9e9 bytes


def long_recording(samples: int) -> Recording:
    depth_m = np.resize(press(1.0), samples)
    force_n = np.resize(recording("one", press(1.0)).force_n, samples)
    rng = np.random.default_rng(samples)
    return Recording("long", depth_m + rng.normal(0, 1e-6, samples), force_n, DT_S)


def peak_bytes(kind: str, samples: int) -> int:
    long = long_recording(samples)
    tracemalloc.start()
    fit_model(kind, "long", [long], FitOptions(trees=2, leaf=50))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak


@pytest.mark.parametrize(
    "kind",
    [
        "rbf-pv",
        pytest.param("rf-fd", marks=pytest.mark.slow),
        pytest.param("hybrid", marks=pytest.mark.slow),
    ],
)
def test_memory_grows_with_few_numbers_a_sample(kind):
    """Two lengths, so that what the capped rows take falls out of the difference."""
    few, many = 60_000, 110_000
    held = (peak_bytes(kind, many) - peak_bytes(kind, few)) / (many - few)
    assert held < 8 * NUMBERS, f"{held:.0f} bytes a sample"
