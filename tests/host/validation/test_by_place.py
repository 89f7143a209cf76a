"""A validation by place: each recording at its own, errors of each, and logs of a chosen place."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.small import DT_S, passive_model, press, scene

import springpot
from springpot import DataError, Model, Recording, Session, UsageError
from springpot.checks import Grade
from springpot.codegen.model.model_file import write_model
from springpot.codegen.model.places import Places
from springpot.host.emission.emission import emit
from springpot.host.validation.parts import PlaceError, place_errors, place_line
from springpot.host.validation.validation import validate
from springpot.host.wings.report.findings import by_place_findings
from springpot.host.wings.report.place_figure import place_figure
from springpot.host.wings.report.scene_page import write_report
from springpot.trainer.models.predict import predict_n
from springpot.trainer.recordings.recording_file import read_recording
from springpot.validation import read_validation, store_validation

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


def test_a_recording_without_a_place_is_refused_by_a_scene_with_a_map(folder: Path) -> None:
    with pytest.raises(DataError, match="has no place, and this scene has a map"):
        validate(folder, [pressed(None)], paced_s=0.01)


def test_a_session_at_a_place_is_logged_with_it_and_repeated_bit_for_bit(
    folder: Path, tmp_path: Path
) -> None:
    logs = []
    for k, place_m in enumerate(PLACES[::2]):
        log = tmp_path / f"felt-{k}.h5"
        url = "sim://ecoflex-00-30"
        with Session(folder, url, log, seconds=0.3, place_m=place_m) as session:
            session.start()
            for _ in session.runner.watch(0.05):
                pass
        logs.append(read_recording(log))
    assert [log.place_m for log in logs] == list(PLACES[::2])
    assert validate(folder, logs, paced_s=0.01).mismatches == 0


def test_a_board_knows_no_place(folder: Path) -> None:
    with pytest.raises(UsageError, match="a board knows no place"):
        validate(folder, [pressed(PLACES[0])], device="serial:///dev/null")


def test_the_line_names_the_worst_place() -> None:
    recordings = [pressed(place_m, f"at-{k}") for k, place_m in enumerate(PLACES)]
    predicted = [
        each.force_n * share for each, share in zip(recordings, (1.01, 0.9, 1.01), strict=True)
    ]
    line = place_line(place_errors(recordings, predicted, [0, 0, 0]))
    assert line.startswith("3 places:") and line.endswith("at (7, 4) mm")


def some_errors(seed: int, count: int) -> list[PlaceError]:
    rng = np.random.default_rng(seed)
    places = rng.uniform(-0.01, 0.03, (count, 2)).tolist()
    percents = rng.uniform(0.5, 20.0, count).tolist()
    return [PlaceError((x, y), 2, 0.1, its) for (x, y), its in zip(places, percents, strict=True)]


def marks_of(figure: str) -> np.ndarray:
    """Where the places are in the picture, (n, 2), pixels."""
    group = figure.split('id="places"')[1].split('id="worst-place"', maxsplit=1)[0]
    return np.array(re.findall(r'<use [^>]*x="([\d.-]+)" y="([\d.-]+)"', group), dtype=float)


def ring_of(figure: str) -> np.ndarray:
    """The middle of the ring, (2,), pixels."""
    outline = re.findall(r' d="([^"]*)"', figure.split('id="worst-place"')[1])[0]
    points = np.array(re.findall(r"(-?[\d.]+) (-?[\d.]+)", outline), dtype=float)
    return (points.min(axis=0) + points.max(axis=0)) / 2


@pytest.mark.parametrize(("seed", "count"), [(0, 2), (1, 6), (2, 25), (3, 80)])
def test_the_picture_has_each_place_and_its_ring_is_the_worst(seed: int, count: int) -> None:
    errors = some_errors(seed, count)
    figure = place_figure(errors, ([0.0, 0.02], [0.0, 0.02]))
    marks = marks_of(figure)[:count]
    worst = int(np.argmax([error.rmse_percent_of_peak for error in errors]))
    assert len(marks) == count
    np.testing.assert_allclose(marks[worst], ring_of(figure), atol=0.1)
    others = np.delete(marks, worst, axis=0)
    assert np.abs(others - ring_of(figure)).max(axis=1).min() > 0.2


def test_one_place_has_no_picture_and_no_finding() -> None:
    assert place_figure(some_errors(0, 1), None) == ""
    assert list(by_place_findings(some_errors(0, 1))) == []


@pytest.mark.parametrize(("worst", "grade"), [(4.9, Grade.GOOD), (6.0, Grade.GOOD),
                                              (20.0, Grade.LOOK)])  # fmt: skip
def test_a_place_that_is_far_worse_than_the_others_is_to_be_looked_at(
    worst: float, grade: Grade
) -> None:
    errors = [PlaceError((0.001 * k, 0.0), 1, 0.1, 4.0) for k in range(4)]
    (found,) = by_place_findings([*errors, PlaceError((0.007, 0.004), 1, 0.1, worst)])
    assert found.grade == grade
    assert "at (7, 4) mm" in found.words


@pytest.mark.slow
def test_the_report_names_the_worst_place_and_draws_all(folder: Path) -> None:
    recordings = [pressed(place_m, f"at-{k}") for k, place_m in enumerate(PLACES)]
    off = replace(recordings[1], force_n=1.2 * recordings[1].force_n)
    store_validation(folder, validate(folder, [recordings[0], off, recordings[2]], paced_s=0.01))
    assert [series.place_m for series in read_validation(folder).series] == list(PLACES)
    page = write_report(folder).read_text()
    assert re.search(r"3 places: .* worst [\d.]+ % at \(7, 4\) mm", page)
    assert 'id="worst-place"' in page
