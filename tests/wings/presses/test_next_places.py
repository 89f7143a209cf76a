"""Places to press next: they tell more of a lump than as many even ones, and are a protocol."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from codegen.stages.test_placed import placed
from scipy.interpolate import LinearNDInterpolator
from support.small import press, recording

from springpot.host.recording.protocols import load_protocol
from springpot.host.wings.presses.next_places import (
    next_places,
    places_of,
    places_words,
    write_places,
)

WIDE_M = 0.03


def even(count: int) -> np.ndarray:
    """As many sites in rows as make a square, (n, 2), m."""
    side = np.linspace(0.0, WIDE_M, count)
    return np.array([(x, y) for x in side for y in side])


@dataclass(frozen=True)
class Lump:
    """Three times as stiff as the ground in its middle."""

    middle_m: np.ndarray
    radius_m: float

    def worth(self, at_m: np.ndarray) -> np.ndarray:
        far = np.sum((at_m - self.middle_m) ** 2, axis=1)
        return np.asarray(1.0 + 2.0 * np.exp(-far / self.radius_m**2))

    def error(self, sites_m: np.ndarray, grid_m: np.ndarray) -> float:
        """How far a map through sites is off between them, RMS."""
        found = LinearNDInterpolator(sites_m, self.worth(sites_m))(grid_m)
        return float(np.sqrt(np.mean((found - self.worth(grid_m)) ** 2)))


@pytest.mark.parametrize("radius_mm", [3.0, 4.0, 6.0])
def test_they_tell_more_of_a_lump_than_as_many_even_ones(radius_mm: float) -> None:
    """Nine after sixteen, or twenty-five at once; the lump is anywhere."""
    grid, chosen, spread = even(41), [], []
    for seed in range(30):
        lump = Lump(np.random.default_rng(seed).uniform(0.2, 0.8, 2) * WIDE_M, 1e-3 * radius_mm)
        first = even(4)
        nine = next_places(first, lump.worth(first), 9)
        chosen.append(lump.error(np.vstack([first, nine]), grid))
        spread.append(lump.error(even(5), grid))
    assert np.mean(chosen) < 0.8 * np.mean(spread)


def test_level_ground_is_looked_at_where_the_sites_are_far_apart() -> None:
    sites_m = np.array([(0.0, 0.0), (0.03, 0.0), (0.0, 0.03), (0.03, 0.03), (0.005, 0.015)])
    ((x_m, _y_m),) = next_places(sites_m, np.ones(5), 1)
    assert x_m > 0.015


@pytest.mark.parametrize(
    "sites_m",
    [
        [(0.0, 0.0), (0.01, 0.0), (0.02, 0.0), (0.03, 0.0)],
        [(0.0, 0.0), (0.001, 0.0), (0.0, 0.001), (0.001, 0.001)],
        [(0.0, 0.0), (0.01, 0.0)],
    ],
)
def test_none_in_a_line_nor_between_sites_that_are_near(sites_m: list[tuple]) -> None:
    assert next_places(np.array(sites_m), np.arange(float(len(sites_m)))).shape == (0, 2)


def test_they_are_a_protocol_of_a_model_with_a_map_and_none_of_another(tmp_path: Path) -> None:
    model = placed("plain", 2)
    sites = [(0.0, 0.0), (0.02, 0.0), (0.0, 0.02), (0.02, 0.02), (0.01, 0.01)]
    pressed = [
        replace(recording(f"p{i}", press(1.0)), place_x_m=site[0], place_y_m=site[1])
        for i, site in enumerate(sites)
    ]
    found = places_of(pressed, model)
    assert len(found) == 6
    write_places(tmp_path / "next.toml", found)
    profiles = load_protocol(str(tmp_path / "next.toml"), 0)
    assert {each.place_m for each in profiles} == {tuple(site) for site in found.tolist()}
    assert f"({1e3 * found[0, 0]:g}, {1e3 * found[0, 1]:g})" in places_words(found, None)
    assert len(places_of([recording("p", press(1.0))], model)) == 0
