"""Radial basis functions keep their digits in float32: no large weights of both signs."""

import numpy as np
import pytest
from support.small import scene, training

from springpot.codegen.plan.plan import make_plan
from springpot.codegen.reference.run import run_reference
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions


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
    assert np.sqrt(np.mean(noise_n**2)) < 2e-4
    assert np.abs(noise_n).max() < 2e-3
