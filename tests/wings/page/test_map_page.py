"""The page of a scene with places: its picture of the object, and the forces that it shows."""

import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from codegen.stages.test_lateral import SLIDING, slid
from codegen.stages.test_placed import called, placed
from host.validation.test_by_place import PLACES, placed_model, pressed
from support.browser import CHROMIUM, layout_faults
from support.paths import TESTS
from support.pressed_page import press_page
from support.small import model_file, scene, small_model, training

from springpot.codegen.model.model import Model
from springpot.codegen.reference.lateral import run_lateral
from springpot.codegen.reference.run import run_reference
from springpot.codegen.scene import Scene
from springpot.host.emission.emission import emit, read_emission
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.toolchain import missing_tools
from springpot.host.validation.store import store_validation
from springpot.host.validation.validation import validate
from springpot.host.wings.page.press_page import write_press_page
from springpot.host.wings.page.scene_entry import module_of, scene_entry
from springpot.host.wings.wasm.wasm_node import missing_node
from springpot.runtime_c.paths import PORT_BROWSER, PORT_WIRE, SIM, flags

LACKING = missing_tools("wasm32") or missing_node() or ("" if CHROMIUM else "no chromium on PATH")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(LACKING), reason=LACKING or "-")]

SURVEY = TESTS / "support" / "c" / "map_survey.mjs"
HELD = scene()
SLID = replace(SLIDING, runtime=HELD.runtime)
SCENES = {"held": HELD, "lateral": SLID}
# Shares of the canvas, and ms: a press that moves while it is pressed, and one elsewhere.
PATHS = [[[0.4, 0.6, 400], *[[0.4 + 0.01 * i, 0.6 - 0.008 * i, 15] for i in range(30)]],
         [[0.7, 0.3, 500]]]  # fmt: skip


def emitted(folder: Path, like: Scene, model: Model) -> Path:
    folder.mkdir(exist_ok=True)
    emit(replace(like, name=folder.name), model_file(folder, model), folder / "c",
         accept_unsafe=True)  # fmt: skip
    return folder / "c"


def page_of(folder: Path, *folders: Path) -> Path:
    write_press_page(folders, folder / "press.html")
    return folder / "press.html"


def surveyed(entry: dict, scratch: Path, depth_m: float) -> np.ndarray:
    """Forces of the page's survey, (rows, columns), N."""
    (scratch / "page.wasm").write_bytes(module_of(entry["wasm"]))
    its, node = entry["map"], shutil.which("node")
    numbers = [*its["survey"], *its["first_m"], *its["last_m"], depth_m, its["press_ticks"],
               entry["dt_s"]]  # fmt: skip
    command = [node, str(SURVEY), str(scratch / "page.wasm"), *map(str, numbers)]
    told = subprocess.run(command, capture_output=True, text=True, check=True)
    columns, rows = its["survey"]
    return np.array(json.loads(told.stdout)).reshape(rows, columns)


def twin_n(folder: Path, entry: dict, place_m: tuple[float, float], depth_m: float) -> float:
    """The reference's force at the end of the survey's press at a place."""
    plan = read_emission(folder).plan
    t = np.arange(entry["map"]["press_ticks"] + 1) / entry["map"]["press_ticks"]
    depth = (depth_m * t * t * (3.0 - 2.0 * t)).astype(plan.dtype)
    if plan.lateral is not None:
        at = np.column_stack([np.full(len(t), place_m[0]), np.full(len(t), place_m[1]), depth])
        return float(run_lateral(plan, at).force_n[-1, 2])
    return float(run_reference(plan, depth, places=[(0, place_m)]).force_n[-1])


@pytest.mark.parametrize("mode", SCENES)
@pytest.mark.parametrize("seed", range(4))
def test_the_picture_is_stiffest_where_the_reference_is(
    tmp_path: Path, seed: int, mode: str
) -> None:
    """Searched for on random maps: no place that is tried is stiffer than held places show."""
    folder = emitted(tmp_path / "map", SCENES[mode], placed("plain", 1 + seed % 3, 10 + seed))
    entry = scene_entry(folder)
    depth_m = 0.4 * entry["map"]["depth_m"]
    force_n = surveyed(entry, tmp_path, depth_m)
    first_m, last_m = np.array(entry["map"]["first_m"]), np.array(entry["map"]["last_m"])
    row, column = np.unravel_index(int(force_n.argmax()), force_n.shape)
    shares = np.array([column, row]) / (np.array(entry["map"]["survey"]) - 1)
    stiffest_m = tuple((first_m + shares * (last_m - first_m)).tolist())
    assert twin_n(folder, entry, stiffest_m, depth_m) == force_n.max()
    tried = first_m + np.random.default_rng(seed).random((40, 2)) * (last_m - first_m)
    found_n = [twin_n(folder, entry, tuple(place.tolist()), depth_m) for place in tried]
    # A tool that slides gives way down the slope on which it presses, off a ridge to either side:
    # no force is above that of a held place, and the picture misses the ridge by what it gives.
    most_n = force_n.max()
    if mode == "lateral":
        held = emitted(tmp_path / "held", SCENES["held"], placed("plain", 1 + seed % 3, 10 + seed))
        most_n = surveyed(scene_entry(held), tmp_path, depth_m).max()
        assert 0.97 * most_n < force_n.max() <= most_n
    assert max(found_n) <= most_n
    assert np.ptp(force_n) > 0.05 * force_n.max()


@pytest.mark.parametrize(("mode", "number"), [("held", "float32"), ("lateral", "float64")])
def test_the_force_shown_is_that_of_the_c(tmp_path: Path, mode: str, number: str) -> None:
    like = replace(SCENES[mode], runtime=scene(number).runtime)
    folder = emitted(tmp_path / "map", like, placed("plain", 2))
    found = press_page(page_of(tmp_path, folder), map=PATHS)
    assert found.console == [] and found.found["errors"] == []
    assert "self-test0 of" in found.found["proof"]
    assert found.csv.startswith("time_s,position_m,force_N,place_x_m,place_y_m")
    rows, library = found.rows[:, 1:].astype(number), SceneLibrary(folder)
    depth_m, force_n, places = rows[:, 0], rows[:, 1], rows[:, 2:4].astype(float)
    pressed = depth_m > 0
    if mode == "held":
        asked = [(k, tuple(place)) for k, place in enumerate(places.tolist())]
        here_n, _ = called(library, depth_m, np.zeros_like(depth_m), asked)
        assert here_n.tobytes() == force_n.tobytes()
        assert len(set(map(tuple, places[pressed]))) == 2  # held while the pointer moves
    else:
        here_n, _ = slid(library, rows[:, [2, 3, 0]])
        assert here_n.tobytes() == np.ascontiguousarray(rows[:, [4, 5, 1]]).tobytes()
        assert np.ptp(rows[pressed, 2]) > 0.001
        assert np.abs(rows[pressed, 4:]).max() > 0.01
        tick = found.found["tick"]
        assert "tick3" in tick and tick in (folder / "sp_scene.c").read_text()
    assert force_n.max() > 0.5


@pytest.mark.parametrize("mode", SCENES)
def test_the_recording_on_the_page_is_rendered_at_its_place(tmp_path: Path, mode: str) -> None:
    like = SCENES[mode]
    folder = emitted(tmp_path / "map", like, placed_model())
    recordings = [pressed(place_m, f"at-{k}") for k, place_m in enumerate(PLACES)][1:]
    store_validation(folder, validate(folder, recordings, paced_s=0.01))
    found = press_page(page_of(tmp_path, folder), map=[PATHS[1]]).found
    assert found["errors"] == []
    assert "the same bits" in found["proof"]
    error_n = float(re.findall(r"([\d.]+) N RMS", found["error"])[0])
    assert error_n < 0.02


@pytest.mark.parametrize("width", [400, 760, 1100, 1600])
@pytest.mark.parametrize("of_map", [True, False])
def test_nothing_sticks_out(tmp_path: Path, width: int, of_map: bool) -> None:
    if of_map:
        folder = emitted(tmp_path / "map", SLID, placed("plain", 2))
    else:
        folder = emitted(tmp_path / "scene", HELD, small_model())
        store_validation(folder, validate(folder, training()[5:6], paced_s=0.1))
    faults = layout_faults(page_of(tmp_path, folder).read_text(), tmp_path, width)
    assert faults == {"out": [], "cut": []}


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(
    ("mode", "names"),
    [("held", ("map", "survey", "held")), ("lateral", ("map", "survey", "slid")), ("", ("",))],
)
def test_the_pages_own_c_has_no_warning(
    tmp_path: Path, compiler: str, mode: str, names: tuple[str, ...]
) -> None:
    model = placed("plain", 2) if mode else small_model()
    folder = emitted(tmp_path / "map", SCENES.get(mode, HELD), model)
    include = [f"-I{place}" for place in (folder, PORT_BROWSER, PORT_WIRE, SIM)]
    for name in ("_".join(["sp_page", its]).strip("_") + ".c" for its in names):
        command = [compiler, *flags("SP_CFLAGS"), *flags("SP_STRICT"), "-fsyntax-only", *include,
                   str(PORT_BROWSER / name)]  # fmt: skip
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stderr
