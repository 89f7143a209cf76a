"""Stored energy: the integral that it stands for. That C gives the same bits: test_lateral.py."""

from dataclasses import replace

import numpy as np
import pytest
from support.small import passive_model

from springpot.codegen.model.formulas import curve_place, curve_values
from springpot.codegen.stages.passive.from_model import hammerstein_stage
from springpot.codegen.stages.passive.hammerstein import HammersteinStage
from springpot.codegen.stages.passive.stored import RENEWED, stored, stored_areas
from springpot.codegen.stages.stage import SceneTicks

STEPS = 20_000


def stage_of(rng: np.random.Generator, nodes: int) -> HammersteinStage:
    """Curves with flat parts."""

    def weights(*shape: int) -> np.ndarray:
        return rng.exponential(5.0, shape) * (rng.uniform(size=shape) < 0.7)

    passive = passive_model().hammerstein
    model = replace(
        passive, elastic_n=weights(nodes), tau_s=np.array([0.01, 0.3]), n_by_depth=1,
        branch_n=weights(2, nodes), radius_m=np.array([1e-3]), stop_n=weights(1, nodes),
        flow=None, damage=None,
    )  # fmt: skip
    return hammerstein_stage(model, SceneTicks(1e-3, vector_width=4), "lateral")


def between(nodes: np.ndarray, begin: float, end: float, less: float) -> float:
    """Integral of a curve, (J + 1, 2), less a constant, N pieces."""
    pieces = len(nodes) - 2 or 1
    u = np.linspace(begin, end, STEPS + 1)
    g = curve_values(nodes[:, :, None], curve_place(u, len(nodes) - 1))[:, 0] - less
    return float(np.sum(0.5 * (g[1:] + g[:-1])) * (end - begin) / STEPS * pieces)


def conjugate(nodes: np.ndarray, z: float) -> float:
    """Most of z x - G(x) over x, N pieces."""
    pieces = len(nodes) - 2 or 1
    x = np.linspace(0.0, 1.5, 10 * STEPS)
    g = curve_values(nodes[:, :, None], curve_place(x, len(nodes) - 1))[:, 0]
    areas = np.concatenate([[0.0], np.cumsum(0.5 * (g[1:] + g[:-1]) * np.diff(x))])
    return float(np.max(z * x - areas)) * pieces


@pytest.mark.parametrize("nodes", [1, 9])
@pytest.mark.parametrize("seed", range(5))
def test_what_is_stored_is_the_integral(seed: int, nodes: int) -> None:
    rng = np.random.default_rng(seed)
    stage = stage_of(rng, nodes)
    u, relaxed, play = rng.uniform(0.0, 1.4, 3).tolist()
    place, at = (curve_place(np.array([x]), nodes) for x in (u, relaxed))
    g, z = (curve_values(stage.branches, each)[0] for each in (place, at))
    found, renewal = stored(stage, stored_areas(stage), place, g - z, np.array([play]))
    wanted = between(stage.spring, 0.0, u, 0.0)
    for k in range(stage.config.n_branches):
        wanted += between(stage.branches[:, :, k], relaxed, u, float(z[k]))
    more = [
        conjugate(stage.branches[:, :, k], (1.0 - RENEWED) * z[k])
        - conjugate(stage.branches[:, :, k], z[k])
        + RENEWED * z[k] * u * (nodes - 1 or 1)
        for k in range(len(z))
    ]
    assert renewal == pytest.approx(sum(more) / RENEWED, rel=1e-4, abs=1e-4)
    # A stop holds what its spring does beyond the play; the spring's own is all of it.
    of_play = curve_values(stage.stops[0][:, :, None], curve_place(np.array([play]), nodes))[0, 0]
    wanted -= between(stage.stops[0], 0.0, play, 0.0) + of_play * (u - play) * (nodes - 1 or 1)
    assert found == pytest.approx(wanted, rel=1e-6, abs=1e-6)
