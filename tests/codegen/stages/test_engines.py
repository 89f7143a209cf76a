"""Engines of the fractional filters and radial functions: what each imitates, and how closely."""

import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest
from support.small import DT_S, model_file, scene, training

from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.features import FirBank
from springpot.codegen.reference import run_reference
from springpot.codegen.stages.exponentials import fast_fir_stage
from springpot.codegen.stages.windows import fir_stage
from springpot.host.emission.emission import emit
from springpot.host.native.scene_library import SceneLibrary
from springpot.trainer.features import compute_response_error, compute_taps, fit_fast_fir_bank
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.rf_fd import PAPER_ORDERS, PAPER_TAPS, build_fractional_features

COLUMNS = np.arange(len(PAPER_ORDERS))


def paper_bank() -> FirBank:
    return build_fractional_features(DT_S, None)


def hand_motion(seconds: float) -> np.ndarray:
    """Presses of many speeds between 0 and 12 mm."""
    t = np.arange(round(seconds / DT_S)) * DT_S
    turns = 2 * np.pi * np.outer(np.geomspace(0.2, 8.0, 9), t) + np.arange(9)[:, None]
    return 0.006 * (1.0 + np.sin(turns).mean(axis=0))


def test_the_fast_window_is_the_window() -> None:
    bank = paper_bank()
    fast = fit_fast_fir_bank(bank)
    assert compute_response_error(bank, fast) < 1e-4
    assert compute_taps(fast).shape == bank.taps.shape == (PAPER_TAPS, len(PAPER_ORDERS))
    worse = dataclasses.replace(fast, weights=fast.weights * 1.01)
    assert compute_response_error(bank, worse) > 9e-3


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_fast_window_is_within_its_error_in_the_number_of_the_scene(dtype: type) -> None:
    bank, fast = paper_bank(), build_fractional_features(DT_S, None, "fir-fast")
    depth, starts = hand_motion(12.0).astype(dtype), np.array([0, 4000])
    found = fast_fir_stage(fast, COLUMNS, DT_S, dtype).reference(depth, starts)
    wanted = fir_stage(bank, COLUMNS, DT_S, np.float64).reference(depth.astype(np.float64), starts)
    shares = np.mean((found - wanted) ** 2, axis=0) / np.mean(wanted**2, axis=0)
    assert np.sqrt(shares[COLUMNS].max()) < (2e-4 if dtype is np.float32 else 1e-5)


@pytest.mark.skipif("SPRINGPOT_SOAK" not in os.environ, reason="1e7 ticks: make soak")
def test_the_fast_window_does_not_drift(tmp_path: Path) -> None:
    """The same features after 1e7 ticks of motion as after none, to the bits' own noise."""
    options = FitOptions(engine="fir-fast", n_centers=20)
    model = fit_model("rbf-fd", "x", training(), options).model
    emit(scene(), model_file(tmp_path, model), tmp_path / "c")
    library = SceneLibrary(tmp_path / "c")
    old, motion = library.new_state(), hand_motion(10.0)
    for _ in range(1000):
        old.run(motion)
    fresh = library.new_state()
    fresh.run(motion)
    again_n, fresh_n = old.run(motion)[0], fresh.run(motion)[0]
    assert np.ptp(fresh_n) > 1.0 and np.abs(again_n - fresh_n).max() < 2e-4 * np.ptp(fresh_n)


@pytest.mark.slow
@pytest.mark.parametrize("n_centers", [100, 300])
def test_float32_adds_less_than_a_fifth_of_a_millinewton_rms(n_centers: int) -> None:
    """Undamped it was 2 mN with 100 centers, 50 mN with 300."""
    model = fit_model("rbf-fd", "x", training(), FitOptions(n_centers=n_centers)).model
    recording = training()[5]
    forces = [
        run_reference(make_plan(model, scene(number=number), True), recording.position_m).force_n
        for number in ("float32", "float64")
    ]
    noise_n = np.asarray(forces[0], dtype=np.float64) - forces[1]
    assert np.sqrt(np.mean(noise_n**2)) < 2e-4 and np.abs(noise_n).max() < 2e-3
