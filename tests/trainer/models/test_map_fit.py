"""The fit of a map: places between sites, and what recordings it refuses."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support.small import DT_S, passive_model, press

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import model_hash, read_model, write_model
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive.map_grid import grid_of
from springpot.trainer.models.predict import predict_n
from springpot.trainer.recordings.recording import Recording

Site = tuple[float, float]
SITES = [(0.01 * i, 0.02 * j) for i in range(3) for j in range(2)]
FULL = (SITES[0], SITES[5])


def pressed(site: Site, full: bool, name: str = "press") -> Recording:
    """Presses of an object with an amount that is bilinear in the place."""
    amount = 0.6 + 40.0 * site[0] + 20.0 * site[1] + 500.0 * site[0] * site[1]
    hz = (0.5, 1.0, 2.0, 4.0) if full else (2.0,)
    parts = [press(each, depth) for each in hz for depth in ((0.006, 0.012) if full else (0.012,))]
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
def test_places_between_the_sites_are_felt_as_they_are() -> None:
    assert fitted().kind == "hammerstein"
    for site in (*SITES, (0.004, 0.013), (0.016, 0.005)):
        measured = pressed(site, full=True)
        found_n = np.maximum(predict_n(fitted(), measured), 0.0)
        assert np.sqrt(np.mean((found_n - measured.force_n) ** 2)) < 0.03 * measured.force_n.max()


@pytest.mark.slow
def test_a_map_comes_back_from_its_file(tmp_path: Path) -> None:
    stored = write_model(tmp_path / "map.spm", fitted())
    assert model_hash(read_model(tmp_path / "map.spm")) == stored


def test_other_kinds_few_sites_and_missing_places_are_refused() -> None:
    whole = recordings()
    with pytest.raises(UsageError, match="rf-fd: has no map, and these recordings are of 6 places"):
        fit_model("rf-fd", "map", whole, FitOptions())
    with pytest.raises(DataError, match="at 4 places, these are of 2"):
        fit_model("hammerstein", "map", whole[:2], FitOptions())
    nowhere = Recording("lost", whole[0].position_m, whole[0].force_n, DT_S)
    with pytest.raises(DataError, match="others none"):
        fit_model("auto", "map", [*whole, nowhere], FitOptions())


@pytest.mark.parametrize("sites", [SITES, [(0.0, 0.0), (0.03, 0.0), (0.02, 0.01), (0.0, 0.03)]])
def test_the_nodes_of_a_grid_cover_the_sites(sites: list[Site]) -> None:
    grid = grid_of(sites)
    nodes = np.stack(np.meshgrid(*(
        grid.first_m[axis] + grid.step_m[axis] * np.arange(grid.nodes[axis]) for axis in (0, 1)
    ), indexing="ij"), axis=-1).reshape(-1, 2)  # fmt: skip
    np.testing.assert_allclose(grid.weights @ nodes, sites, atol=1e-12)
    np.testing.assert_allclose(grid.weights.sum(axis=1), 1.0)
