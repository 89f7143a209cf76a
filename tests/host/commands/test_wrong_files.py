"""A file of another kind, or none, in the place of each: a line that says what is wanted."""

from pathlib import Path

import pytest
from support.in_process import spring
from support.small import model_file, training

from springpot.host.api.files import write_recordings

MODEL, SCENE = "`springpot train --out FILE.spm` makes one", "scene file"
FOLDER, RECORDING = "not an emitted folder", "`springpot import` makes them"


def words(command: str, file: Path, job: Path) -> tuple[object, ...]:
    """Give a file where a command takes a model, a scene, an emitted folder or a recording."""
    return {
        "model": ("emit", "--model", file, "--out", "new"),
        "scene": ("emit", "--scene", file, "--out", "new"),
        "folder": ("validate", file, job / "rec"),
        "recording": ("validate", job / "c", file),
    }[command]


@pytest.mark.parametrize(
    ("command", "wanted"),
    [("model", MODEL), ("scene", SCENE), ("folder", FOLDER), ("recording", RECORDING)],
)
def test_what_is_wanted_is_said(command: str, wanted: str, job: Path, tmp_path: Path) -> None:
    write_recordings(tmp_path / "press.h5", training()[0])
    files = {
        "none": tmp_path / "none", "recording": tmp_path / "press.h5", "folder": job / "c",
        "model": model_file(tmp_path), "recordings": job / "rec",
    }  # fmt: skip
    right = {"recording": ("recording", "recordings")}.get(command, (command,))
    for kind in files.keys() - {*right}:
        done = spring(*words(command, files[kind], job))
        assert done.returncode in (2, 3), (kind, done.stderr)
        assert done.stderr.count("\n") == 1
        assert str(files[kind]) in done.stderr
        assert wanted in done.stderr, (kind, done.stderr)
    assert not Path("new").exists()
