"""Extremes and steps of forests: against every vector of a grid that meets every leaf."""

import json
from itertools import product

import numpy as np
import pytest
from support.small import scene, small_model

from springpot.codegen.emit.files import manifest_text
from springpot.codegen.model.forest_extremes import forest_extremes, forest_step
from springpot.codegen.model.regressors import Forest, Quantisation
from springpot.codegen.plan.force_facts import force_facts
from springpot.codegen.plan.make_plan import make_plan

GRID = 8  # thresholds lie between its lines
SPLITS = 5


def random_forest(seed: int, trees: int, n_features: int, quantisation: bool = False) -> Forest:
    """Trees whose splits may leave empty leaves; thresholds at k + 1/2 of k = 0 .. GRID - 2."""
    rng = np.random.default_rng(seed)
    feature, threshold, left, right, roots = [], [], [], [], []
    for _ in range(trees):
        root = len(feature)
        roots.append(root)
        rows = 2 * SPLITS + 1
        feature += [*rng.integers(0, n_features, SPLITS), *[-1] * (rows - SPLITS)]
        threshold += [*(rng.integers(0, GRID - 1, SPLITS) + 0.5), *[0.0] * (rows - SPLITS)]
        left += [root + 2 * k + 1 if k < SPLITS else 0 for k in range(rows)]
        right += [root + 2 * k + 2 if k < SPLITS else 0 for k in range(rows)]
    value_n = rng.normal(0.0, 1.0, len(feature))
    bins = (
        Quantisation(np.full(n_features, -0.5), np.full(n_features, 2.0)) if quantisation else None
    )
    if bins is not None:  # x is above t from bin 2 (t + 1/2) on: between the grid's lines again
        threshold = [2.0 * at + 1.0 for at in threshold]
    return Forest(
        np.array(feature, np.int32), np.array(threshold, np.float64), np.array(left, np.int32),
        np.array(right, np.int32), value_n, np.array(roots, np.int32), 1.0 / trees, 0.25, bins,
    )  # fmt: skip


def force_n(forest: Forest, x: np.ndarray) -> float:
    if forest.quantisation is not None:
        own = forest.quantisation
        x = np.floor((x - own.feature_min) * own.bins_per_unit + 0.5)
    total = 0.0
    for root in forest.roots:
        node = root
        while forest.feature[node] >= 0:
            goes_left = x[forest.feature[node]] <= forest.threshold[node]
            node = forest.left[node] if goes_left else forest.right[node]
        total += forest.value_n[node]
    return forest.bias_n + forest.weight * total


def grid(n_features: int) -> list[np.ndarray]:
    return [np.array(point, float) for point in product(range(GRID), repeat=n_features)]


@pytest.mark.parametrize("quantised", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_extremes_are_those_of_every_vector(seed: int, quantised: bool) -> None:
    forest = random_forest(seed, 6, 3, quantised)
    forces = [force_n(forest, x) for x in grid(3)]
    smallest, largest = forest_extremes(forest, 3)
    assert smallest.exact
    assert largest.exact
    assert smallest.force_n == pytest.approx(min(forces), abs=1e-12)
    assert largest.force_n == pytest.approx(max(forces), abs=1e-12)


@pytest.mark.parametrize("quantised", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_a_step_is_that_of_every_vector(seed: int, quantised: bool) -> None:
    forest = random_forest(seed, 4, 3, quantised)
    change = np.array([1.0, 0.0, -1.0])
    steps = [abs(force_n(forest, x + change) - force_n(forest, x)) for x in grid(3)]
    # Vectors beyond the grid have the leaves of its border.
    beyond = [abs(force_n(forest, x) - force_n(forest, x - change)) for x in grid(3)]
    found = forest_step(forest, change)
    assert found.exact
    assert found.force_n == pytest.approx(max(*steps, *beyond), abs=1e-12)


def test_a_search_that_is_cut_short_still_bounds() -> None:
    forest = random_forest(3, 8, 3)
    highest = max(force_n(forest, x) for x in grid(3))
    exact = forest_extremes(forest, 3)[1]
    rough = forest_extremes(forest, 3, max_compared=1)[1]
    assert rough.force_n >= highest >= rough.reached_n
    assert rough.force_n >= exact.force_n


def test_the_manifest_has_them_with_the_devices_step() -> None:
    plan = make_plan(small_model(), scene())
    facts = json.loads(manifest_text(plan, force_facts(plan)))["forest"]
    assert facts["exact"]
    assert facts["min_n"] <= 0.01 < facts["max_n"]
    assert facts["resolution_m"] == pytest.approx(1e-5)
    assert 0.0 < facts["step_n"] <= facts["max_n"] - facts["min_n"]
