"""The page in a browser: the forces of the PC bit for bit, the words of the stability check."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.browser import NEEDS_PAGES
from support.in_process import spring
from support.pressed_page import Pressed, press_page
from support.small import model_file, scene, small_model, training

from springpot.codegen.model.model import Model
from springpot.codegen.scene import Device
from springpot.host.emission.emission import emit
from springpot.host.page.press_page import write_press_page
from springpot.host.validation.store import store_validation
from springpot.host.validation.validation import validate
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording_file import read_recording

pytestmark = [pytest.mark.slow, *NEEDS_PAGES]


ASSUMED = Device()


def fitted(kind: str) -> Model:
    return fit_model(kind, kind, training(), FitOptions(seed=1, trees=5, leaf=20)).model


def emitted(
    folder: Path,
    model: Model,
    number: str = "float32",
    mode: str = "off",
    device: Device = ASSUMED,
) -> Path:
    folder.mkdir(exist_ok=True)
    chosen = replace(scene(number=number, mode=mode), name=folder.name, device=device)
    emit(chosen, model_file(folder, model), folder / "c", accept_unsafe=True)
    return folder / "c"


def page_of(folder: Path, *folders: Path) -> Path:
    write_press_page(folders, folder / "press.html")
    return folder / "press.html"


@pytest.mark.parametrize(
    ("kind", "number", "mode"),
    [
        ("hammerstein", "float32", "off"),
        ("hammerstein", "float64", "proxy"),
        ("rf-fd", "float32", "off"),
        ("rbf-pv", "float64", "off"),
    ],
)
def test_what_is_pressed_is_what_validate_computes(
    tmp_path: Path, kind: str, number: str, mode: str
) -> None:
    folder = emitted(tmp_path / "scene", fitted(kind), number, mode)
    store_validation(folder, validate(folder, training()[5:6], paced_s=0.1))
    pressed = press_page(page_of(tmp_path, folder))
    assert pressed.console == []
    assert pressed.found["errors"] == []
    assert pressed.found["fetched"] == []
    assert "the same bits" in pressed.found["proof"]
    assert pressed.found["tick"] in (folder / "sp.c").read_text()
    assert re.search(r"self-test0 of \d+ steps differ", pressed.found["proof"])
    (tmp_path / "pressed.csv").write_text(pressed.csv)
    assert spring("import", tmp_path / "pressed.csv", "--out", tmp_path / "in").returncode == 0
    imported = read_recording(tmp_path / "in" / "pressed.h5")
    assert imported.position_m.max() > 0.003
    found = validate(folder, [imported], paced_s=0.1)
    assert found.mismatches == 0
    dtype = np.dtype(number)
    there = np.array([float(row.split(",")[2]) for row in pressed.csv.split()[1:]])
    assert there.max() > 0.5
    assert (found.predicted_n[0].astype(dtype) == there.astype(dtype)).all()


def test_another_object_is_taken_up_at_rest(tmp_path: Path) -> None:
    folders = [emitted(tmp_path / name, fitted("hammerstein")) for name in ("soft", "other")]
    pressed = press_page(page_of(tmp_path, *folders), pick=1)
    assert pressed.found["object-name"] == "other"
    assert pressed.found["said"] == "Now you press other; the file begins anew."
    assert pressed.rows[0, 2] == 0.0
    assert pressed.rows[:, 2].max() > 0.5


HOLD = [0.3 + 0.3 * min(1.0, i / 50) for i in range(150)]


def shaking_mps(pressed: Pressed) -> float:
    return float(pressed.found["vibration"].removesuffix(" mm/s"))


def test_delay_makes_a_stiff_object_shake_as_the_check_says(tmp_path: Path) -> None:
    folder = emitted(tmp_path / "stiff", fitted("hammerstein").stiffened(5.0))
    page = page_of(tmp_path, folder)
    for delay in (0, 3):
        pressed = press_page(page, path=HOLD, sliders={"delay": delay})
        assert shaking_mps(pressed) > 5.0 if delay else shaking_mps(pressed) < 1.0
        (tmp_path / "scene.toml").write_text(
            f'schema = 1\nname = "stiff"\nmodel = "{folder / "from" / "model.spm"}"\n'
            f'[coupling]\nmode = "off"\n[device]\ndelay_samples = {delay}\n'
        )
        assert pressed.found["device"].startswith("assumed device: 0.3 kg, 4 N s/m")
        assert ("vibrates" in pressed.found["state"]) == (delay > 0)
        told = json.loads(spring("stability", "--scene", tmp_path / "scene.toml", "--json").stdout)
        assert told["recommendation"].startswith(pressed.found["verdict"])
        limit_npm = told["limit"]["max_stiffness_npm"]["mid, 0 more samples"]
        assert f"{1e-3 * limit_npm:.3g} N/mm" in pressed.found["limit"]


def test_the_page_holds_the_scenes_own_device(tmp_path: Path) -> None:
    """An object that the assumed device holds quietly makes a light, late one shake."""
    light = Device(mass_kg=0.05, viscous_nspm=0.5, delay_s=0.003)
    folder = emitted(tmp_path / "light", fitted("hammerstein").stiffened(5.0), device=light)
    pressed = press_page(page_of(tmp_path, folder), path=HOLD)
    assert pressed.found["device"] == "the scene's device: 0.05 kg, 0.5 N s/m, 3 ms late."
    assert pressed.found["verdict"].startswith("Unstable")
    assert shaking_mps(pressed) > 5.0


def test_a_page_that_cannot_run_says_so(tmp_path: Path) -> None:
    page = page_of(tmp_path, emitted(tmp_path / "scene", small_model()))
    page.write_text(page.read_text().replace("DecompressionStream(", "MissingStream("))
    pressed = press_page(page)
    assert pressed.found["broken"].startswith("This page cannot run here: MissingStream")
