"""The grid of a map: with twice as many nodes as sites it is off by less between them."""

import numpy as np
import pytest

from springpot.codegen.model.passive import amounts_at
from springpot.trainer.models.passive.map_problem import grid_of

WIDE_M, ROUGH = 0.03, 1e-3
DENSE_M = np.array([(x, y) for x in np.linspace(0, WIDE_M, 31) for y in np.linspace(0, WIDE_M, 31)])


def even(wide: int, high: int) -> list[tuple[float, float]]:
    return [(x, y) for x in np.linspace(0, WIDE_M, wide) for y in np.linspace(0, WIDE_M, high)]


def scattered(rng: np.random.Generator, count: int) -> list[tuple[float, float]]:
    """Corners, and the others anywhere."""
    return [*even(2, 2), *map(tuple, rng.uniform(0.0, WIDE_M, (count - 4, 2)).tolist())]


def lump(at_m: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    middle_m, radius_m = rng.uniform(0.2, 0.8, 2) * WIDE_M, rng.uniform(0.2, 0.5) * WIDE_M
    return 1.0 + np.exp(-np.sum((at_m - middle_m) ** 2, axis=1) / radius_m**2)


def error(sites: list[tuple[float, float]], seed: int, finer: int) -> float:
    """How far a map of least squares and least bend is off between the sites, RMS."""
    grid = grid_of(sites, finer)
    seen = lump(np.array(sites), np.random.default_rng(seed))
    true = lump(DENSE_M, np.random.default_rng(seed))
    rough = ROUGH * finer**2 * grid.roughness
    nodes = np.linalg.solve(grid.weights.T @ grid.weights + rough, grid.weights.T @ seen)
    of_nodes = nodes.reshape(*grid.nodes, 1)
    found = [amounts_at(of_nodes, grid.first_m, 1.0 / grid.step_m, at)[0] for at in DENSE_M]
    return float(np.sqrt(np.mean((np.array(found) - true) ** 2)))


# Sites of 30 lumps of a fifth of the width or more, and the error that twice the nodes leave.
LEFT = {("even", 2): 1.001, ("even", 4): 0.8, ("even", 5): 0.6, ("even", 7): 0.3}
LEFT |= {("anywhere", count): 0.75 for count in (20, 25, 40)}


@pytest.mark.few(1)
@pytest.mark.parametrize(("way", "count"), LEFT)
def test_twice_the_nodes_make_less_error(way: str, count: int) -> None:
    def errors(finer: int) -> np.ndarray:
        drawn = (scattered(np.random.default_rng(seed), count) for seed in range(30))
        sites = drawn if way == "anywhere" else [even(count, count)] * 30
        return np.array([error(each, seed, finer) for seed, each in enumerate(sites)])

    finer, coarse = errors(2), errors(1)
    assert np.mean(finer) < LEFT[way, count] * np.mean(coarse)
    assert way == "anywhere" or finer.max() < 1.001 * coarse.max()
