"""A recorded slide: read with its places, refused by a fit, compared along all three axes."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from codegen.stages.test_lateral import at_depth, slow
from support.files.columns import write_columns
from support.small import DT_S, press, scene

from springpot import DataError, FitOptions, Recording, ScenePlaces, check_recordings
from springpot.checks import Grade
from springpot.codegen.model.model_file import write_model
from springpot.console import validation_rows
from springpot.host.emission.emission import emit
from springpot.host.validation.validation import Validation, validate
from springpot.host.wings.report.findings import slide_findings
from springpot.host.wings.report.relaxation import recorded_hold
from springpot.modelling import fit_model
from springpot.native import Replay, SceneLibrary
from springpot.trainer.recordings.formats.importing import import_file
from springpot.validation import SlideError, read_validation, store_validation

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    where = tmp_path_factory.mktemp("slides")
    write_model(where / "model.spm", slow())
    modes = {
        "lateral": ScenePlaces("lateral", 8.0),
        "rubbing": ScenePlaces("lateral", 8.0, friction=0.3),
        "held": ScenePlaces(),
    }
    for mode, places in modes.items():
        its = replace(scene(energy="off"), places=places)
        emit(its, where / "model.spm", where / mode, accept_unsafe=True)
    return {mode: where / mode for mode in modes}


def path_m(seed: int) -> np.ndarray:
    """A press that wanders over the map, (n, 3), m."""
    depth_m = np.concatenate([press(2.0), 0.7 * press(3.0)])
    turns = np.random.default_rng(seed).uniform(0.3, 2.0, (2, 1)) * np.linspace(0, 6, len(depth_m))
    return at_depth(depth_m, *(np.sin(turns) * [[0.009], [0.015]]))


def recorded(path: np.ndarray, force_n: np.ndarray, dt_s: float = DT_S) -> Recording:
    names = ("x_m", "y_m", "x_n", "y_n")
    lateral = dict(zip(names, np.column_stack([path[:, :2], force_n[:, :2]]).T, strict=True))
    return Recording("slid", path[:, 2], force_n[:, 2], dt_s, channels=lateral)


def rendered(folder: Path, seed: int) -> Recording:
    """What the C gives, as a recording."""
    path = path_m(seed)
    force_n, _ = Replay(SceneLibrary(folder)).slide(path)
    return recorded(path, force_n.astype(float))


def compared(folder: Path, recordings: Sequence[Recording]) -> Validation:
    found = validate(folder, recordings, paced_s=0.01)
    assert found.mismatches == 0
    return found


@pytest.mark.parametrize("seed", range(3))
def test_an_object_that_is_the_scene_is_without_error(folders: dict[str, Path], seed: int) -> None:
    slide = rendered(folders["lateral"], seed)
    (error,) = compared(folders["lateral"], [slide]).slides
    assert error.rmse_percent_of_peak < 1e-4
    assert error.lateral_rms_n is not None and error.lateral_rms_n > 0.0
    assert error.lateral_rmse_n == pytest.approx(0.0, abs=1e-5)
    assert error.correlation == pytest.approx(1.0)
    assert error.work_j == pytest.approx(error.c_work_j, rel=1e-4)
    assert error.work_j is not None and error.work_j > 0.0  # a real object takes work


@pytest.mark.parametrize(
    ("axis", "gain"), [("x_n", -1.0), ("y_n", -1.0), ("x_n", 0.5), ("force_n", 1.2), ("x_m", -1.0)]
)
def test_whatever_is_not_the_object_is_an_error_of_its_axis(
    folders: dict[str, Path], axis: str, gain: float
) -> None:
    slide = rendered(folders["lateral"], 1)
    if axis == "force_n":
        wrong = replace(slide, force_n=gain * slide.force_n)
    else:
        wrong = replace(slide, channels={**slide.channels, axis: gain * slide.channels[axis]})
    (error,) = compared(folders["lateral"], [wrong]).slides
    sideways, along = error.lateral_rmse_n > 1e-3, error.rmse_percent_of_peak > 1.0
    assert (sideways, along) == (axis != "force_n", axis in ("force_n", "x_m"))


@pytest.mark.parametrize("scenes", ["lateral", "rubbing"])
@pytest.mark.parametrize(("objects", "friction"), [("lateral", 0.0), ("rubbing", 0.3)])
@pytest.mark.parametrize("seed", range(2))
def test_the_friction_of_the_object_is_found_whatever_the_scene_has(
    folders: dict[str, Path], scenes: str, objects: str, friction: float, seed: int
) -> None:
    slide = rendered(folders[objects], seed)
    noise = np.random.default_rng(seed)
    noisy = {
        name: samples + noise.normal(0.0, 2e-6 if name[2] == "m" else 0.01, samples.shape)
        for name, samples in slide.channels.items()
    }
    found = compared(folders[scenes], [replace(slide, channels=noisy)])
    assert found.slides[0].friction == pytest.approx(friction, abs=0.03)
    assert "places.friction = " in validation_rows(found)["slides"]


def test_a_slower_slide_without_a_lateral_force_is_compared_along_the_depth(
    folders: dict[str, Path],
) -> None:
    slide = rendered(folders["lateral"], 2)
    slower = replace(
        slide,
        position_m=slide.position_m[::4],
        force_n=slide.force_n[::4],
        dt_s=4.0 * DT_S,
        channels={name: slide.channels[name][::4] for name in ("x_m", "y_m")},
    )
    found = compared(folders["lateral"], [slower])
    assert found.slides[0].rmse_percent_of_peak < 2.0
    assert found.slides[0].lateral_rmse_n is None
    assert "sideways" not in validation_rows(found)["slides"]


def test_columns_of_places_that_change_are_a_slide(
    folders: dict[str, Path], tmp_path: Path
) -> None:
    slide = rendered(folders["lateral"], 0)
    read = import_file(write_columns(tmp_path / "slide.csv", slide), None, "none", None)
    assert "slides: x " in read.guess
    (found,) = read.recordings
    for name, samples in slide.channels.items():
        np.testing.assert_allclose(found.channels[name], samples, atol=1e-9)
    row = validation_rows(compared(folders["lateral"], [found]))["slides"]
    assert row.startswith("1 slide: along the depth") and "correlation 1.00" in row


def test_what_takes_presses_alone_says_so(folders: dict[str, Path]) -> None:
    slide = rendered(folders["lateral"], 0)
    with pytest.raises(DataError, match=r"slid: slides \(x .* mm, y .* mm\).*springpot validate"):
        fit_model("auto", "m", [slide], FitOptions())
    with pytest.raises(DataError, match=r"emit it with \[places\] mode"):
        validate(folders["held"], [slide], paced_s=0.01)


def test_the_page_has_slides_and_takes_no_slide_for_a_hold(folders: dict[str, Path]) -> None:
    path = path_m(4)
    path[400:, 2] = path[400, 2]  # held at a depth, and slid
    force_n, _ = Replay(SceneLibrary(folders["lateral"])).slide(path)
    slide = recorded(path, force_n.astype(float))
    store_validation(folders["lateral"], compared(folders["lateral"], [slide]))
    stored = read_validation(folders["lateral"])
    assert [item.slides for item in stored.series] == [True]
    assert recorded_hold(stored.series) is None
    errors = [SlideError(**each) for each in stored.metadata["result"]["slides"]]
    (found,) = slide_findings(errors)
    assert (found.grade, found.todo) == (Grade.GOOD, "")
    (off,) = slide_findings([replace(errors[0], rmse_percent_of_peak=11.0)])
    assert off.grade == Grade.LOOK and "places.friction" in off.todo


def test_a_slide_is_not_judged_as_a_press(folders: dict[str, Path]) -> None:
    """Held at its depth the force changes with the place: no sensor is at its limit there."""
    path = path_m(3)
    path[:, 2] = np.minimum(path[:, 2], 0.004)
    force_n, _ = Replay(SceneLibrary(folders["lateral"])).slide(path)
    report = check_recordings([recorded(path, -force_n.astype(float))])
    assert report.findings == [] and "not judged" in report.sign_words
