"""Where force begins: a zero that is not the surface, and an object that has not recovered."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.presses.structures import recorded

from springpot import Recording
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.contact_point import find_contact
from springpot.trainer.recordings.quality.finding import Finding
from springpot.trainer.recordings.quality.report import contact_findings

TIME_S = np.arange(4000) * 1e-3


def press(surface_m: float, seed: int, power: float = 1.5, depth_m: float = 8e-3) -> Recording:
    """Cycles from 1 mm above position 0, on an object whose surface is at `surface_m`."""
    rng = np.random.default_rng(seed)
    position_m = -1e-3 + 0.5 * depth_m * (1.0 - np.cos(2.0 * np.pi * TIME_S))
    share = np.maximum(position_m - surface_m, 0.0) / depth_m
    force_n = 12.0 * share**power + rng.normal(0.0, 0.01, len(TIME_S))
    return Recording(f"{seed:02}", position_m, force_n, 1e-3)


def contacts(recordings: list[Recording]) -> list[Finding]:
    return [found for found in contact_findings(recordings) if found.kind == "contact"]


@pytest.mark.parametrize("seed", range(10))
def test_a_dented_object_is_not_put_at_0_press_by_press(seed: int) -> None:
    """It is met at 0 first and then deeper, in any order of the files."""
    rng = np.random.default_rng(seed)
    dents_m = np.concatenate([[0.0], rng.uniform(1e-3, 3e-3, rng.integers(1, 6))])
    rng.shuffle(dents_m)
    presses = [press(dent_m, i, rng.uniform(1.0, 2.0)) for i, dent_m in enumerate(dents_m)]
    (found,) = contacts(presses)
    assert "not at 0" not in found.what and "--rest-s" in found.to_do
    timed = [replace(item, start_s=float(5 * i)) for i, item in enumerate(presses)]
    timed[0] = replace(timed[0], position_m=timed[0].position_m - dents_m[0])
    assert contacts(timed) == []


@pytest.mark.parametrize("seed", range(10))
def test_a_zero_that_is_not_the_surface_is_said_once_for_the_set(seed: int) -> None:
    rng = np.random.default_rng(seed)
    places_m = rng.uniform(2e-3, 3e-3, 5)
    presses = [press(place_m, i, rng.uniform(1.0, 2.0)) for i, place_m in enumerate(places_m)]
    (found,) = contacts(presses)
    assert found.where == "5 recordings" and "not at 0" in found.what
    assert "--contact-force auto" in found.to_do


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bergstrom-boyce", "mullins", "poro-viscoelastic"])
def test_a_session_on_a_simulated_object_needs_no_other_zero(name: str, tmp_path: Path) -> None:
    """Its position 0 is the surface; it does not recover between the presses."""
    recordings = recorded(f"sim://{name}?rest=2", "third-repeat", tmp_path / "a")
    assert any(item.start_s for item in recordings) and contacts(list(recordings)) == []


def test_the_doubt_covers_the_surface_of_any_power_law() -> None:
    """Spheres (1.5), cones (2) and what stiffens more: the line back alone misses two of three."""
    rng, missed = np.random.default_rng(3), 0
    for seed in range(60):
        surface_m, power = rng.uniform(0.0, 2e-3), rng.uniform(1.0, 2.5)
        try:
            found = find_contact(press(surface_m, seed, power))
        except DataError:
            continue
        missed += abs(found.position_m - surface_m) > found.uncertainty_m + 2e-5
    assert missed <= 9


@pytest.mark.parametrize("seed", range(5))
def test_an_object_that_stiffens_exponentially_has_a_surface(seed: int) -> None:
    """As tissue does: the law has none, and where force is seen it is not far above."""
    item = press(0.0, seed)
    depth_m = np.maximum(item.position_m, 0.0)
    noise_n = np.random.default_rng(seed).normal(0.0, 0.01, len(depth_m))
    tissue = replace(item, force_n=12.0 * np.expm1(1e3 * depth_m) / np.expm1(7.0) + noise_n)
    found = find_contact(tissue)
    assert abs(found.position_m) < found.uncertainty_m and abs(found.position_m) < 1e-3


@pytest.mark.parametrize("rate_hz", [20.0, 50.0, 100.0, 1000.0])
def test_the_doubt_covers_the_surface_at_the_rate_of_a_camera(rate_hz: float) -> None:
    """Presses of three speeds in any order: the fast ones step over the first contact."""
    missed = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        way_m = rng.uniform(1e-3, 5e-3) + 5e-3
        ramps = [np.arange(0.0, way_m, v / rate_hz) for v in rng.permutation([5e-3, 2e-2, 6e-2])]
        pieces = [[up, np.full(20, way_m), up[::-1], np.zeros(20)] for up in ramps]
        position_m = np.concatenate([part for piece in pieces for part in piece])
        force_n = 3.0 * (np.maximum(position_m - way_m + 5e-3, 0.0) / 5e-3) ** rng.uniform(1.0, 2.0)
        force_n += rng.normal(0.0, 0.01, len(position_m))
        found = find_contact(Recording(f"{seed:02}", position_m, force_n, 1.0 / rate_hz))
        missed += abs(found.position_m - way_m + 5e-3) > found.uncertainty_m + 2e-5
    assert missed <= 3


@pytest.mark.parametrize("count", [0.5, 1.0, 2.0])
def test_resolution_and_noise_make_neither_a_surface_nor_a_preload(count: float) -> None:
    """count: of the sensor, in standard deviations of the noise; the tool rests outside."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        rest_m, up_m = np.full(600, -2.5e-4), np.linspace(-2.5e-4, 5e-3, 200)
        position_m = np.concatenate([rest_m, up_m, up_m[::-1]])
        share = np.maximum(position_m, 0.0) / 5e-3
        noise_n = 10.0 ** rng.uniform(-2.5, -1.8)
        force_n = share ** rng.uniform(1.0, 2.0) + rng.normal(0.0, noise_n, len(share))
        force_n = np.round(force_n / (count * noise_n)) * count * noise_n
        assert contacts([Recording(f"{seed:02}", position_m, force_n, 5e-3)]) == []
