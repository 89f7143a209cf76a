"""Recordings that are slower than a scene: given at its ticks, compared at their samples."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.small import model_file, scene, training

from springpot import Recording
from springpot.codegen.scene import Runtime
from springpot.host.emission.emission import emit
from springpot.host.validation.compared import at_samples, at_ticks, samples_of
from springpot.host.validation.validation import validate


@pytest.mark.parametrize("tick_hz", [1000.0, 1280.0, 8000.0])
@pytest.mark.parametrize("own_hz", [10.0, 128.0, 999.0])
def test_there_and_back_is_the_recording(own_hz: float, tick_hz: float) -> None:
    generator = np.random.default_rng(1)
    position_m, force_n = np.cumsum(generator.normal(size=(2, 300)), axis=1)
    own = Recording("x", 1e-4 * position_m, force_n, 1 / own_hz)
    ticked = at_ticks(own, 1 / tick_hz)
    back_n = at_samples(ticked.force_n, own, 1 / tick_hz)
    whole = tick_hz % own_hz == 0
    steepest = np.abs(np.diff(force_n)).max()
    last = -1 if not whole else None  # a last sample between two ticks has no tick behind it
    assert np.abs(back_n - force_n)[:last].max() <= (1e-9 if whole else steepest)
    assert samples_of(len(ticked.force_n), own, 1 / tick_hz) == pytest.approx(300, abs=1)
    assert at_ticks(own, 1 / own_hz) is own


def test_the_error_is_that_at_the_recorded_samples(tmp_path: Path) -> None:
    """A slower recording of a press has the error of those of its samples that are there."""
    recordings = training()[:3]
    tenth = [
        replace(r, position_m=r.position_m[::10], force_n=r.force_n[::10], dt_s=10 * r.dt_s)
        for r in recordings
    ]
    model_file(tmp_path)
    emit(replace(scene(), runtime=Runtime()), tmp_path / "model.spm", tmp_path / "c")
    whole, slow = (validate(tmp_path / "c", each, paced_s=0.0) for each in (recordings, tenth))
    assert slow.mismatches == 0
    for item, force_n, slow_n in zip(tenth, whole.predicted_n, slow.predicted_n, strict=True):
        assert len(slow_n) == len(item.force_n)
        assert np.abs(force_n[::10] - slow_n)[3:].max() < 0.02 * np.abs(item.force_n).max()
    assert slow.model_rmse_n == pytest.approx(whole.model_rmse_n, rel=0.2)
