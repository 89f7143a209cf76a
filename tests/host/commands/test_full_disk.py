"""A disk that fills up in a write: one line, what was there stands, nothing is left beside it."""

import resource
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from support.in_process import spring
from support.small import model_file, scene, training

from springpot.host.emission.emission import emit
from springpot.trainer.recordings.recording_file import write_recording


@contextmanager
def files_of_at_most(n_bytes: int) -> Iterator[None]:
    """A write beyond that fails, as on a full disk: the system says so to whoever writes."""
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, usual[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)


def content(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file()
    }


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("full")
    (folder / "rec").mkdir()
    for item in training():
        write_recording(folder / "rec" / f"{item.name}.h5", item)
    model_file(folder)
    emit(scene(), folder / "model.spm", folder / "c")
    (folder / "scene.toml").write_text('schema = 1\nname = "test"\nmodel = "model.spm"\n')
    done = spring("validate", folder / "c", "--recording", folder / "rec")
    assert done.returncode == 0, done.stderr
    assert spring("report", folder / "c").returncode == 0
    return folder


@pytest.mark.parametrize(
    "arguments",
    [
        ["train", "rec", "--model", "rf-fd", "--out", "model.spm"],
        ["emit", "--scene", "scene.toml", "--out", "c"],
        ["validate", "c", "--recording", "rec"],
        ["report", "c"],
        ["export", "rec", "--to", "csv", "--out", "csv"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_nothing_is_left_and_what_was_there_stands(
    arguments: list[str], job: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(job, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    before = content(tmp_path)
    with files_of_at_most(1000):
        done = spring(*arguments)
    assert done.returncode == 2, done.stderr
    assert "choose another " in done.stderr.splitlines()[-1]
    assert content(tmp_path) == before
