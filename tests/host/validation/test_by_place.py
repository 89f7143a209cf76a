"""A validation by place: each recording at its own, errors of each, and logs of a chosen place."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.sessions import ended
from support.small import DT_S, passive_model, press, scene

import springpot
from springpot import Model, Recording
from springpot.codegen.model.model_file import write_model
from springpot.codegen.model.passive import Places
from springpot.host.emission.emission import emit
from springpot.host.validation.validation import validate
from springpot.trainer.models.predict import predict_n
from springpot.trainer.recordings.recording_file import read_recording

PLACES = ((0.0, 0.0), (0.007, 0.004), (0.01, 0.01))


def placed_model() -> Model:
    model = passive_model()
    passive = model.hammerstein
    amounts = np.array([[[0.5], [0.7]], [[0.9], [1.0]]])
    grid = np.zeros(2), np.full(2, 0.01)
    places = Places(*grid, amounts, passive.slopes_n[None])
    return replace(model, hammerstein=replace(passive, places=places))


def pressed(place_m: tuple[float, float] | None, name: str = "press") -> Recording:
    x_m, y_m = place_m or (None, None)
    position_m = press(2.0, cycles=2)
    like = Recording(name, position_m, position_m, DT_S, place_x_m=x_m, place_y_m=y_m)
    return replace(like, force_n=np.maximum(predict_n(placed_model(), like), 0.0))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("placed")
    write_model(where / "model.spm", placed_model())
    emit(scene(), where / "model.spm", where / "c")
    return where / "c"


def test_each_recording_is_rendered_at_its_place(folder: Path) -> None:
    recordings = [pressed(place_m, f"at-{k}") for k, place_m in enumerate(PLACES)]
    found = validate(folder, recordings, paced_s=0.01)
    assert found.mismatches == 0
    assert [error.place_m for error in found.places] == list(PLACES)
    assert max(error.rmse_percent_of_peak for error in found.places) < 1.0
    moved = replace(recordings[0], place_x_m=0.01, place_y_m=0.01)
    assert validate(folder, [moved], paced_s=0.01).places[0].rmse_percent_of_peak > 10.0


@pytest.mark.parametrize("seed", range(3))
def test_python_renders_what_has_a_place_at_it(folder: Path, seed: int) -> None:
    x_m, y_m = np.random.default_rng(seed).uniform(-0.002, 0.012, 2).tolist()
    placed, bare = pressed((x_m, y_m)), pressed(None).position_m
    validated = validate(folder, [placed], paced_s=0.01).predicted_n[0]
    scene, model = springpot.load(folder), placed_model()
    for given in (scene.run(placed), scene.run(bare, place_m=(x_m, y_m))):
        np.testing.assert_array_equal(given[0], validated.astype(given[0].dtype))
    for force_n in (
        springpot.predict(model, placed),
        springpot.predict(model, bare, place_m=(x_m, y_m)),
    ):
        np.testing.assert_array_equal(force_n, placed.force_n)


@pytest.mark.parametrize("place", [(6.0, 3.0), (0.0, float("nan")), (-float("inf"), 0.0)])
def test_a_place_in_millimetres_is_refused(folder: Path, place: tuple[float, float]) -> None:
    bare = pressed(None).position_m
    for render in (
        springpot.load(folder).run,
        lambda position_m, place_m: springpot.predict(placed_model(), position_m, place_m=place_m),
    ):
        with pytest.raises(ValueError, match="from -1 to 1 m"):
            render(bare, place_m=place)


def test_a_map_without_a_place_says_which_one_it_renders(folder: Path) -> None:
    bare, stiffest = pressed(None), pressed((0.01, 0.01))
    scene, model = springpot.load(folder), placed_model()
    for given in (bare, bare.position_m):
        with pytest.warns(UserWarning, match=r"no place: .* stiffest place, \(10, 10\) mm"):
            force_n = scene.run(given)[0]
        np.testing.assert_array_equal(force_n, scene.run(stiffest)[0])
        with pytest.warns(UserWarning, match=r"no place: .* stiffest place, \(10, 10\) mm"):
            np.testing.assert_array_equal(springpot.predict(model, given), stiffest.force_n)


@pytest.mark.slow
def test_a_session_at_a_place_is_logged_with_it_and_repeated_bit_for_bit(
    folder: Path, tmp_path: Path
) -> None:
    logs = []
    for k, place_m in enumerate(PLACES[::2]):
        log = tmp_path / f"felt-{k}.h5"
        url = "sim://ecoflex-00-30"
        ended(folder, url, log, seconds=0.3, place_m=place_m)
        logs.append(read_recording(log))
    assert [log.place_m for log in logs] == list(PLACES[::2])
    assert validate(folder, logs, paced_s=0.01).mismatches == 0
