"""The page that is pressed in a browser: its forces have the bits of the C."""

import base64
import json
import shutil
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.in_process import spring
from support.small import model_file, passive_model, scene

from springpot.codegen.errors import UsageError
from springpot.codegen.model.model_file import write_model
from springpot.codegen.model.places import Places
from springpot.host.emission.emission import emit
from springpot.host.pages import press_page
from springpot.host.pages.press_page import write_press_page
from springpot.trainer.recordings.recording import Recording

NEEDS_CLANG = pytest.mark.skipif(
    shutil.which("clang") is None or shutil.which("wasm-ld") is None,
    reason="no clang and wasm-ld: apt-get install clang lld",
)


def emitted(folder: Path, number: str = "float32", mode: str = "off", prefix: str = "sp") -> Path:
    folder.mkdir()
    chosen = replace(scene(number=number, mode=mode, prefix=prefix), name=folder.name)
    emit(chosen, model_file(folder, passive_model()), folder / "c", accept_unsafe=True)
    return folder / "c"


@NEEDS_CLANG
def test_the_command_states_what_the_page_holds(tmp_path: Path) -> None:
    folder = emitted(tmp_path / "soft")
    done = spring("page", folder, "--out", tmp_path / "press.html", "--json")
    found = json.loads(done.stdout)
    assert found["bytes"] == (tmp_path / "press.html").stat().st_size
    assert found["without_recording"] == ["soft"]
    (one,) = found["scenes"]
    assert one["name"] == "soft" and 1000 < one["wasm_bytes"] < found["bytes"]
    node = shutil.which("node") is not None
    assert (one["selftest"], one["force_hash"] is not None) == (
        (0, True) if node else (None, False)
    )


def test_a_scene_with_places_is_refused_in_one_line(tmp_path: Path) -> None:
    model = passive_model()
    places = Places(
        np.zeros(2), np.full(2, 0.01), np.ones((2, 2, 1)), model.hammerstein.slopes_n[None]
    )
    with_places = replace(model, hammerstein=replace(model.hammerstein, places=places))
    write_model(tmp_path / "model.spm", with_places)
    emit(scene(), tmp_path / "model.spm", tmp_path / "c")
    with pytest.raises(UsageError, match="has places; the page presses one point"):
        write_press_page([tmp_path / "c"], tmp_path / "press.html")


def test_a_missing_compiler_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, module = emitted(tmp_path / "soft"), "springpot.host.pages.wasm_module"
    monkeypatch.setattr(f"{module}.shutil.which", lambda _: None)
    monkeypatch.setattr(f"{module}.packaged_compiler", lambda: ())
    with pytest.raises(
        UsageError, match="no compiler for WebAssembly: `apt-get install clang lld`"
    ):
        write_press_page([folder], tmp_path / "press.html")


def test_a_page_shows_the_first_recording_that_was_validated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = [Recording(f"{k}", 1e-3 * k * np.arange(3.0), np.arange(3.0), 1e-3) for k in (1, 2)]
    pairs = [(recording, recording.force_n) for recording in shown]
    monkeypatch.setattr(press_page, "read_validation", lambda _: (None, pairs))
    packed = press_page._recording(tmp_path)
    assert packed is not None
    depth_m = np.frombuffer(zlib.decompress(base64.b64decode(packed[0])), np.float32)
    np.testing.assert_allclose(depth_m, [0.0, 1e-3, 2e-3])
