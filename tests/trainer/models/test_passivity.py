"""An adversary presses passive models: no closed press may give energy back.

A press starts in equilibrium and ends at rest at the depth where it began. Energy is the trapezoid
sum of float64 force over depth. It may fall below zero by the sum's own error only: BOUND of peak
force times stroke, at 1500 smooth samples a press for the search, 6000 for what it found.
"""

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any
from unittest import mock

import numpy as np
import pytest
from scipy.optimize import minimize
from support.small import DT_S, passive_force_n, press, soft_force

from springpot import Recording
from springpot.codegen.model.formulas import compute_depth_loss, play_operator
from springpot.codegen.model.passive import Damage, Flow, Hammerstein
from springpot.codegen.stages.passive.hammerstein import hammerstein_stage
from springpot.codegen.stages.stage import SceneTicks
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.hammerstein import fit_hammerstein
from springpot.trainer.models.passive.growth import Growth, extrapolate_curves
from springpot.trainer.models.training_set import build_training_set

BOUND = 1e-5
SAMPLES = 1500
WAVES = 6
SPAN_M = 0.012
RANDOM, STARTS, STEPS = 300, 3, 300
LONGEST_S, SHORTEST_S = 20.0, 0.02
# Cosines and sines of a press of so many samples, each (WAVES, samples).
TURNS = {n: 2 * np.pi * np.arange(1, WAVES + 1)[:, None] * np.linspace(0.0, 1.0, n)
         for n in (SAMPLES, 4 * SAMPLES)}  # fmt: skip
ROUND = {n: (np.cos(turns), np.sin(turns)) for n, turns in TURNS.items()}
Force = Callable[[np.ndarray, float], np.ndarray]


def closed_press(numbers: np.ndarray, samples: int) -> tuple[np.ndarray, float]:
    """Depths (m) and their step (s): from and to one depth, at rest at both ends."""
    start, duration, *waves = numbers
    t, (cosines, sines) = np.linspace(0.0, 1.0, samples), np.reshape(waves, (2, WAVES, 1))
    motion = (cosines * ROUND[samples][0] + sines * ROUND[samples][1]).sum(axis=0)
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


def model_force(model: Hammerstein, surface: bool = False) -> Force:
    """Through the C, which is as the reference: `test_the_c_is_the_reference`."""
    return lambda depth_m, dt_s: passive_force_n(model, depth_m, dt_s, surface)


@cache
def fitted() -> Hammerstein:
    """Fitted to an object with friction, so that stops are chosen."""
    recordings = []
    for share, frequency_hz in product((0.3, 0.7, 1.0), (0.5, 2.0, 5.0)):
        depth_m = press(frequency_hz, share * SPAN_M)
        force_n = soft_force(depth_m) + 150.0 * (
            depth_m - np.array(play_operator(depth_m, depth_m[0], np.float64(0.002)))
        )
        recordings.append(Recording(f"{share}-{frequency_hz}", depth_m, force_n, DT_S))
    fit = fit_hammerstein("x", build_training_set(recordings, smooth_s=0.0), FitOptions())
    assert len(fit.model.hammerstein.radius_m) > 0 < len(fit.model.hammerstein.tau_s)
    return fit.model.hammerstein


def random_model(seed: int, surface: bool = False) -> Hammerstein:
    """Any non-negative mixture of all that the model has; one with a surface begins at it."""
    rng = np.random.default_rng(seed)
    n, poles, stops = rng.choice([1, 9, 13]), rng.integers(1, 5), rng.integers(0, 4)
    flow, damage = rng.integers(0, 4), rng.integers(0, 3)

    def weights(*shape: int) -> np.ndarray:
        return rng.exponential(5.0, shape) * (rng.uniform(size=shape) < 0.6)

    model = Hammerstein(
        origin_m=0.0 if surface else float(rng.uniform(0.0, 0.3) * SPAN_M),
        span_m=SPAN_M,
        elastic_n=weights(n),
        tau_s=10.0 ** rng.uniform(-3.0, 1.5, poles),
        branch_n=weights(poles, n) + 0.1,
        radius_m=rng.uniform(0.01, 0.6, stops) * SPAN_M,
        stop_n=weights(stops, n),
        bias_n=0.0 if surface else float(rng.normal()),
        n_by_depth=int(rng.integers(0, poles + 1)),
        rate_ratio=float(16.0 ** rng.uniform(-1.0, 1.0)),
        flow=Flow(rate_ps=10.0 ** rng.uniform(-1.0, 4.0, flow), power=rng.choice([3, 5], flow),
                  degree=rng.choice([1, 2, 4], flow), force_n=weights(flow)),
        damage=Damage(heal_s=rng.choice([0.0, 0.3, 5.0], damage), power=rng.choice([1, 3], damage),
                      curve_n=weights(damage, n)),
        recovers=surface,
    )  # fmt: skip
    return (
        extrapolate_curves(model, Growth(rng.dirichlet(np.ones(4)), rng.random() < 0.5))
        if n > 1
        else model
    )


@pytest.mark.slow
def test_no_press_of_a_fitted_model_gives_energy_back() -> None:
    assert max_returned(model_force(fitted()), seed=1) < BOUND


@pytest.mark.few(1)
@pytest.mark.parametrize("surface", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_the_c_is_the_reference(seed: int, surface: bool) -> None:
    model, rng = random_model(seed, surface), np.random.default_rng(seed)
    depth_m, dt_s = closed_press(rng.normal(0.3, 0.3, 2 + 2 * WAVES), SAMPLES)
    force_n = model_force(model, surface)(depth_m, dt_s)
    stage = hammerstein_stage(model, SceneTicks(dt_s, surface=surface), "penetration")
    wanted_n = stage.reference(depth_m, np.array([0]))
    np.testing.assert_array_equal(force_n, wanted_n)
    assert np.ptp(force_n) > 0.0


HUNDREDS = [range(k, k + 100) for k in range(1000, 2000, 100)]


@pytest.mark.few(1, 12)
@pytest.mark.parametrize("seeds", [*([seed] for seed in range(8)), *HUNDREDS])
def test_no_press_of_a_random_non_negative_model_gives_energy_back(seeds: Sequence[int]) -> None:
    few = {"presses": 12, "starts": 1, "steps": 40} if len(seeds) > 1 else {}
    for seed in seeds:
        assert max_returned(model_force(random_model(seed)), seed, **few) < BOUND, seed


def special(**changed: Any) -> Hammerstein:
    """Branches alone, and what is given."""
    branch_n = np.full((3, 9), 16.0)
    plain = {"origin_m": 0.0, "span_m": SPAN_M, "elastic_n": branch_n[0], "bias_n": 0.0,
             "tau_s": np.array([0.02, 0.2, 2.0]), "branch_n": branch_n,
             "radius_m": np.zeros(0), "stop_n": np.zeros((0, 9))}  # fmt: skip
    return Hammerstein(**plain | changed)


FLOW = Flow(np.array([10.0, 10.0]), np.array([3, 5]), np.array([1, 4]), np.array([5.0, 5.0]))
DAMAGE = Damage(np.array([0.0, 0.5]), np.array([1, 3]), np.full((2, 9), 16.0))
BY_DEPTH = {"n_by_depth": 3, "rate_ratio": 16.0}
PLANTED: dict[str, tuple[Hammerstein, str, Callable[..., Any]]] = {
    "a curve that falls where the rate follows the depth": (
        special(branch_n=np.full((3, 9), 16.0) - 300.0 * (np.arange(9) == 5), **BY_DEPTH), "", abs,
    ),
    "a loss below 0": (
        special(**BY_DEPTH), "springpot.codegen.stages.passive.maxwell.compute_depth_loss",
        lambda *given: -1e-3 * compute_depth_loss(*given),
    ),
    "a branch that pulls": (
        special(branch_n=np.outer([-3.0, 1.0, 1.0], np.full(9, 16.0))), "", abs,
    ),
    "a stop that pulls": (
        special(radius_m=np.array([3e-3]), stop_n=np.full((1, 9), -48.0)), "", abs,
    ),
    "a flow that pulls": (special(flow=replace(FLOW, force_n=-FLOW.force_n)), "", abs),
    "damage that stiffens": (
        special(damage=replace(DAMAGE, curve_n=-DAMAGE.curve_n)), "", abs,
    ),
}  # fmt: skip


@pytest.mark.few(1)
@pytest.mark.parametrize("fault", PLANTED)
def test_the_adversary_finds_a_planted_fault(fault: str) -> None:
    model, where, wrong = PLANTED[fault]
    with mock.patch(where, wrong) if where else nullcontext():
        assert max_returned(model_force(model), seed=1, presses=40) > 1000 * BOUND


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(8))
def test_what_lets_go_gives_no_energy_back(seed: int) -> None:
    force = model_force(random_model(seed, surface=True), surface=True)
    assert max_returned(force, seed=seed) < BOUND


def test_the_clamp_alone_gives_energy_back_and_the_surface_does_not() -> None:
    """A branch deep inside, pressed so slowly that it costs nothing, pulls when the tool is back.

    The clamp hides that it pulls, while another branch near the surface is pressed against it for
    nothing too. The first one forgets faster: what is left pushes the tool out.
    """
    branch_n = np.zeros((2, 9))
    branch_n[0, 5], branch_n[1, 1] = 20.0, 3.0
    model = special(elastic_n=np.zeros(9), tau_s=np.array([1.0, 2.0]), branch_n=branch_n)
    corners_s = np.cumsum([0.0, 5e4, 0.2, 2.0, 0.2, 1.4, 0.2])
    depth_m = SPAN_M * np.interp(
        np.arange(0.0, corners_s[-1], 0.02), corners_s, [0.0, 0.75, 0.0, 0.0, 0.25, 0.25, 0.0]
    )
    shares = []
    for recovers in (False, True):
        force_n = passive_force_n(replace(model, recovers=recovers), depth_m, 0.02, True)
        energy_j = np.sum(0.5 * (force_n[1:] + force_n[:-1]) * np.diff(depth_m))
        shares.append(-energy_j / (np.ptp(force_n) * np.ptp(depth_m)))
    assert shares[0] > 0.01 and shares[1] <= 0.0
