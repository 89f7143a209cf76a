"""The fit of a map: places between sites, a grid with twice as many nodes, what it refuses."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.presses.places import grid_profiles
from support.small import DT_S, passive_model, press, scene

from springpot import Model, Recording
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.model.model_file import write_model
from springpot.codegen.model.places import interpolate_amounts
from springpot.host.emission.emission import emit
from springpot.host.recording.protocols import load_protocol
from springpot.host.recording.session import open_press_device, record_session
from springpot.host.validation.validation import validate
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive.map_fit import _rescale_sites, _site_normal_equations
from springpot.trainer.models.passive.map_problem import MapProblem, build_grid
from springpot.trainer.models.passive.passive_terms import plain_terms
from springpot.trainer.models.predict import predict_n
from springpot.trainer.models.training_set import build_training_set
from springpot.trainer.recordings.recording_file import read_recordings

Site = tuple[float, float]
SITES = [(0.01 * i, 0.02 * j) for i in range(3) for j in range(2)]
FULL = (SITES[0], SITES[5])


def pressed(site: Site, full: bool, name: str = "press", deeper: float = 1.0) -> Recording:
    """Presses of an object with an amount that is bilinear in the place."""
    amount = 0.6 + 40.0 * site[0] + 20.0 * site[1] + 500.0 * site[0] * site[1]
    hz = (0.5, 1.0, 2.0, 4.0) if full else (2.0,)
    depths_m = (0.006, 0.012) if full else (deeper * 0.012,)
    parts = [press(each, depth_m) for each in hz for depth_m in depths_m]
    position_m = np.concatenate(parts)
    alone = Recording(name, position_m, np.zeros_like(position_m), DT_S)
    force_n = amount * np.maximum(predict_n(passive_model(), alone), 0.0)
    return Recording(name, position_m, force_n, DT_S, place_x_m=site[0], place_y_m=site[1])


def recordings() -> list[Recording]:
    return [pressed(site, site in FULL, f"at-{k}") for k, site in enumerate(SITES)]


@cache
def fitted() -> Model:
    return fit_model("auto", "map", recordings(), FitOptions()).model


@pytest.mark.slow
def test_places_between_the_sites_are_felt_as_they_are(tmp_path: Path) -> None:
    assert fitted().kind == "hammerstein"
    sites = (*SITES, (0.004, 0.013), (0.016, 0.005))
    deeper = [pressed(site, False, "deeper", 1.2) for site in sites[-2:]]
    for measured in (*(pressed(site, full=True) for site in sites), *deeper):
        errors_n = np.maximum(predict_n(fitted(), measured), 0.0) - measured.force_n
        # A constant slope errs by 2 % of the peak a fifth deeper.
        allowed = 0.003 if measured.name == "deeper" else 0.03
        assert np.sqrt(np.mean(errors_n**2)) < allowed * measured.force_n.max()
    write_model(tmp_path / "model.spm", fitted())
    emit(scene(), tmp_path / "model.spm", tmp_path / "c")
    assert validate(tmp_path / "c", deeper).mismatches == 0


def test_other_kinds_few_sites_and_missing_places_are_refused() -> None:
    whole = recordings()
    with pytest.raises(UsageError, match="rf-fd: has no map, and these recordings are of 6 places"):
        fit_model("rf-fd", "map", whole, FitOptions())
    with pytest.raises(DataError, match="at 4 places, these are of 2"):
        fit_model("hammerstein", "map", whole[:2], FitOptions())
    nowhere = Recording("lost", whole[0].position_m, whole[0].force_n, DT_S)
    with pytest.raises(DataError, match="lost: no place"):
        fit_model("auto", "map", [*whole, nowhere], FitOptions())


def test_sites_of_any_amount_show_one_law() -> None:
    data = build_training_set([pressed(site, False) for site in SITES], 0.0)
    pairs = zip(data.recordings, data.depths_m, strict=True)
    of_sites = [replace(data, recordings=(one,), depths_m=(depth_m,)) for one, depth_m in pairs]
    amounts = np.array([one.force_n.max() for one in data.recordings])
    alike = _rescale_sites(of_sites, range(len(SITES)), amounts)
    assert [one.force_n.max() for one in alike.recordings] == pytest.approx([amounts.mean()] * 6)
    its = _site_normal_equations(of_sites[5], plain_terms(of_sites[5], 9), 1e-4)
    assert its.square == pytest.approx(np.sum(data.recordings[5].force_n ** 2), rel=1e-3)  # N^2


def test_a_second_material_has_to_earn_it_at_sites_left_out() -> None:
    def fitted(inside: list[int], _: int) -> tuple[np.ndarray, np.ndarray]:
        return np.isin(np.arange(6), inside)[:, None] / 1.0, np.ones((1, 1))

    site, grid = SimpleNamespace(rmse=lambda its: its[0]), SimpleNamespace(weights=np.eye(6))
    known: Any = SimpleNamespace(sites=[site] * 6, grid=grid, fitted=fitted)
    assert MapProblem._cross_validated_rmse_n(known, 1, seed=0) == 0.0  # no site knows itself
    for second_n, count in ((0.95, 1), (0.85, 2)):
        its: Any = SimpleNamespace(_cross_validated_rmse_n=lambda k, _, n=second_n: (1.0, n)[k - 1])
        assert MapProblem.chosen(its, 0) == (count, (1.0, second_n)[count - 1])
    wide = [(0.01 * i, 0.01 * j) for i in range(4) for j in range(2)]
    assert build_grid(wide).nodes == (10, 3)  # as close in x as in y


@cache
def lump() -> Model:
    """A map of 5 x 5 recorded sites."""
    with TemporaryDirectory() as folder:
        sites, bench = Path(folder) / "sites", open_press_device("sim://lump")
        record_session(bench, "sim://lump", "map", grid_profiles(5), sites)
        return fit_model("auto", "lump", read_recordings([sites]), FitOptions()).model


@pytest.mark.long
def test_a_recorded_lump_is_felt_between_its_sites(tmp_path: Path) -> None:
    write_model(tmp_path / "model.spm", lump())
    emit(scene(), tmp_path / "model.spm", tmp_path / "c")
    places = np.random.default_rng(7).uniform(0.0, 0.03, (20, 2)).tolist()
    motions = load_protocol("validation", 3)
    signals = [
        replace(motions[k % 10], name=f"{k:02d}", place_m=(x, y)) for k, (x, y) in enumerate(places)
    ]
    bench = open_press_device("sim://lump?seed=500")
    record_session(bench, "sim://lump", "test", signals, tmp_path / "test")
    found = validate(tmp_path / "c", read_recordings([tmp_path / "test"]), paced_s=0.01)
    percents = np.array([error.rmse_percent_of_peak for error in found.places])
    assert found.mismatches == 0 and len(percents) == 20
    assert np.exp(np.mean(np.log(percents))) < 2.4 and percents.max() < 7.0


WIDE_M, ROUGH = 0.03, 1e-3
DENSE_M = np.array([(x, y) for x in np.linspace(0, WIDE_M, 31) for y in np.linspace(0, WIDE_M, 31)])


def even(wide: int, high: int) -> list[tuple[float, float]]:
    return [(x, y) for x in np.linspace(0, WIDE_M, wide) for y in np.linspace(0, WIDE_M, high)]


def scattered(rng: np.random.Generator, count: int) -> list[tuple[float, float]]:
    """Corners, and the others anywhere."""
    return [*even(2, 2), *map(tuple, rng.uniform(0.0, WIDE_M, (count - 4, 2)).tolist())]


def smooth_lump(at_m: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    middle_m, radius_m = rng.uniform(0.2, 0.8, 2) * WIDE_M, rng.uniform(0.2, 0.5) * WIDE_M
    return 1.0 + np.exp(-np.sum((at_m - middle_m) ** 2, axis=1) / radius_m**2)


def error(sites: list[tuple[float, float]], seed: int, finer: int) -> float:
    """How far a map of least squares and least bend is off between the sites, RMS."""
    grid = build_grid(sites, finer)
    seen = smooth_lump(np.array(sites), np.random.default_rng(seed))
    true = smooth_lump(DENSE_M, np.random.default_rng(seed))
    rough = ROUGH * finer**2 * grid.roughness
    nodes = np.linalg.solve(grid.weights.T @ grid.weights + rough, grid.weights.T @ seen)
    of_nodes = nodes.reshape(*grid.nodes, 1)
    found = [
        interpolate_amounts(of_nodes, grid.first_m, 1.0 / grid.step_m, at)[0] for at in DENSE_M
    ]
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
