"""An adversary presses passive models: no closed press may give energy back.

A press starts in equilibrium and ends at rest at the depth where it began. Energy is the trapezoid
sum of float64 force over depth. It may fall below zero by the sum's own error only: BOUND of peak
force times stroke, at 1500 smooth samples a press for the search, 6000 for what it found.
"""

import dataclasses
from collections.abc import Callable
from functools import cache
from unittest import mock

import numpy as np
import pytest
from scipy.optimize import minimize
from support.small import DT_S, press, soft_force

from springpot.codegen.model.formulas import loss_by_depth
from springpot.codegen.model.model import BASIS_SIZE, Basis, Hammerstein
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.hammerstein import fit_hammerstein
from springpot.trainer.models.passive import passive_fit, passive_terms
from springpot.trainer.models.passive.passive_terms import hammerstein_force, play
from springpot.trainer.models.training_set import training_set
from springpot.trainer.recordings.recording import Recording

BOUND = 1e-5
SAMPLES = 1500
WAVES = 6
SPAN_M = 0.012
RANDOM, STARTS, STEPS = 150, 3, 150
LONGEST_S, SHORTEST_S = 20.0, 0.02
BASES: tuple[Basis, ...] = ("powers", "ramps")
Force = Callable[[np.ndarray, float], np.ndarray]


def closed_press(numbers: np.ndarray, samples: int) -> tuple[np.ndarray, float]:
    """Depths (m) and their step (s): from and to one depth, at rest at both ends."""
    start, duration, *waves = numbers
    t = np.linspace(0.0, 1.0, samples)
    k = np.arange(1, WAVES + 1)[:, None]
    cosines, sines = np.reshape(waves, (2, WAVES, 1))
    motion = (cosines * np.cos(2 * np.pi * k * t) + sines * np.sin(2 * np.pi * k * t)).sum(axis=0)
    # Soft at the surface: a kink would be the trapezoids' error, not the model's.
    depth = np.clip(start, 0.0, 1.0) + np.sin(np.pi * t) ** 2 * motion
    depth = 0.5 * (depth + np.sqrt(depth**2 + 4e-4))
    duration_s = SHORTEST_S * (LONGEST_S / SHORTEST_S) ** np.clip(duration, 0.0, 1.0)
    return SPAN_M * depth, duration_s / (samples - 1)


def returned(force: Force, numbers: np.ndarray, samples: int = SAMPLES) -> float:
    """Energy that a press gets back, as a share of peak force times stroke."""
    depth_m, dt_s = closed_press(numbers, samples)
    force_n = force(depth_m, dt_s)
    energy_j = np.sum(0.5 * (force_n[1:] + force_n[:-1]) * np.diff(depth_m))
    return float(-energy_j / max(np.ptp(force_n) * np.ptp(depth_m), 1e-12))


def max_returned(
    force: Force, seed: int, presses: int = RANDOM, starts: int = STARTS, steps: int = STEPS
) -> float:
    """The maximum share found by random presses and a local search from the best of them."""
    rng = np.random.default_rng(seed)
    size = rng.choice([0.1, 0.3, 1.0], presses)[:, None]
    tried = np.concatenate(
        [rng.uniform(0.0, 1.0, (presses, 2)), size * rng.normal(0.0, 0.4, (presses, 2 * WAVES))],
        axis=1,
    )
    shares = np.array([returned(force, numbers) for numbers in tried])
    found = list(tried[np.argsort(shares)[-starts:]])
    for numbers in tuple(found):
        found.append(minimize(
            lambda x: -returned(force, x), numbers, method="Powell", options={"maxfev": steps}
        ).x)  # fmt: skip
    return max(returned(force, numbers, 4 * SAMPLES) for numbers in found)


def model_force(model: Hammerstein) -> Force:
    return lambda depth_m, dt_s: hammerstein_force(model, depth_m, dt_s, np.arange(len(depth_m)))


@cache
def fitted(basis: Basis) -> Hammerstein:
    """Fitted to an object with friction, so that stops are chosen."""
    recordings = []
    for share in (0.3, 0.7, 1.0):
        for frequency_hz in (0.5, 2.0, 5.0):
            depth_m = press(frequency_hz, share * SPAN_M)
            force_n = soft_force(depth_m) + 150.0 * (depth_m - play(depth_m, 0.002))
            recordings.append(Recording(f"{share}-{frequency_hz}", depth_m, force_n, DT_S))
    data = training_set(recordings, smooth_s=0.0)
    shapes = tuple(shape for shape in passive_fit.PLAIN if shape.basis == basis)
    with mock.patch.multiple(passive_fit, PLAIN=shapes, RATE_RATIOS=()):
        fit = fit_hammerstein("x", data, FitOptions())
    assert fit.model.hammerstein is not None
    assert len(fit.model.hammerstein.radius_m) > 0
    assert len(fit.model.hammerstein.tau_s) > 0
    return fit.model.hammerstein


def random_model(seed: int) -> Hammerstein:
    rng = np.random.default_rng(seed)
    basis = BASES[seed % 2]
    n, poles, stops = BASIS_SIZE[basis], rng.integers(1, 5), rng.integers(0, 4)

    def weights(*shape: int) -> np.ndarray:
        return rng.exponential(5.0, shape) * (rng.uniform(size=shape) < 0.6)

    return Hammerstein(
        basis=basis,
        origin_m=float(rng.uniform(0.0, 0.3) * SPAN_M),
        span_m=SPAN_M,
        elastic_n=weights(n),
        tau_s=10.0 ** rng.uniform(-3.0, 1.5, poles),
        branch_n=weights(poles, n) + 0.1,
        radius_m=rng.uniform(0.01, 0.6, stops) * SPAN_M,
        stop_n=weights(stops, n),
        bias_n=float(rng.normal()),
        n_by_depth=int(rng.integers(0, poles + 1)),
        rate_ratio=float(16.0 ** rng.uniform(-1.0, 1.0)),
        stretch=float(rng.choice([0.0, 0.0, 6.0, 12.0])) if basis == "ramps" else 0.0,
    )


@pytest.mark.parametrize("basis", BASES)
def test_no_press_of_a_fitted_model_gives_energy_back(basis: Basis) -> None:
    assert max_returned(model_force(fitted(basis)), seed=1) < BOUND


@pytest.mark.parametrize("seed", range(8))
def test_no_press_of_a_random_non_negative_model_gives_energy_back(seed: int) -> None:
    assert max_returned(model_force(random_model(seed)), seed=seed) < BOUND


@pytest.mark.slow
@pytest.mark.parametrize("group", range(10))
def test_none_of_a_thousand_random_models_gives_energy_back(group: int) -> None:
    for seed in range(1000 + 100 * group, 1100 + 100 * group):
        found = max_returned(model_force(random_model(seed)), seed, presses=12, starts=1, steps=40)
        assert found < BOUND, seed


@pytest.mark.parametrize("basis", BASES)
@pytest.mark.parametrize("part", ["branch_n", "stop_n"])
def test_the_adversary_finds_one_negative_weight(basis: Basis, part: str) -> None:
    model = fitted(basis)
    weights = getattr(model, part).copy()
    strongest = np.unravel_index(int(np.argmax(weights)), weights.shape)
    weights[strongest] = -3.0 * weights.sum()
    active = dataclasses.replace(model, **{part: weights})
    assert max_returned(model_force(active), seed=1) > 1000 * BOUND


def test_the_adversary_finds_a_play_used_as_a_force() -> None:
    assert max_returned(lambda depth_m, _: play(depth_m, 0.1 * SPAN_M), seed=1) > 1000 * BOUND


def by_depth() -> Hammerstein:
    """Three branches that relax sixteen times faster at the surface, on a stretched depth."""
    model = random_model(1)
    branch_n = np.full((3, BASIS_SIZE["ramps"]), 2.0)
    return dataclasses.replace(
        model, basis="ramps", elastic_n=branch_n[0], tau_s=np.array([0.02, 0.2, 2.0]),
        branch_n=branch_n, n_by_depth=3, rate_ratio=16.0, stretch=6.0,
    )  # fmt: skip


def test_no_press_of_rates_by_depth_gives_energy_back() -> None:
    assert max_returned(model_force(by_depth()), seed=1) < BOUND


def test_the_adversary_finds_a_curve_that_falls_where_the_rate_follows_the_depth() -> None:
    model = by_depth()
    branch_n = model.branch_n.copy()
    branch_n[1, 5] = -3.0 * branch_n.sum()
    active = dataclasses.replace(model, branch_n=branch_n)
    assert max_returned(model_force(active), seed=1) > 1000 * BOUND


def test_the_adversary_finds_a_loss_below_zero() -> None:
    grows = mock.patch.object(
        passive_terms, "loss_by_depth", lambda *given: -1e-3 * loss_by_depth(*given)
    )
    with grows:
        assert max_returned(model_force(by_depth()), seed=1, presses=20) > 1000 * BOUND
