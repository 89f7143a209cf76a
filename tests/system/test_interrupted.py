"""Ctrl-C: wherever a command is, one line, status 130, and no half of a file."""

import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from support.in_process import spring
from support.pages.prepared_pages import emitted_job
from support.peer import CLI

pytestmark = pytest.mark.slow

# Of each command, what it writes. The files of a folder are whole or not there.
COMMANDS = {
    "record --device sim://ecoflex-00-30 --protocol paper --out new": "new",
    "train training --model rf-fd --out new.spm": "new.spm",
    "emit --scene scene.toml --out new": "new",
    "validate c --recording validation": "c/validation",
    "report c": "c/report.html",
    "bench --recording training --model rbf-fd --out new": "new",
}
AFTER_S = (0.6, 1.4)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Recordings, a model, a scene; the scene emitted and validated."""
    place = tmp_path_factory.mktemp("interrupted")
    emitted_job(place)
    assert spring("validate", place / "c", "--recording", place / "validation").returncode == 0
    return place


def whole_files(place: Path) -> dict[Path, bytes]:
    """Every file with its content; asserts that none is a part, or empty but for marks."""
    found = {}
    for file in (item for item in sorted(place.rglob("*")) if item.is_file()):
        assert not file.name.endswith(".part"), file
        found[file] = file.read_bytes()
        assert found[file] or file.name.startswith("."), f"{file} is empty"
    return found


@pytest.mark.parametrize("line", COMMANDS)
def test_nothing_is_left_half_written(folder: Path, line: str) -> None:
    before = whole_files(folder)
    for after_s in AFTER_S:
        process = subprocess.Popen(
            [*CLI, *line.split()], cwd=folder, start_new_session=True, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip
        time.sleep(after_s)
        os.killpg(process.pid, signal.SIGINT)
        _, err = process.communicate(timeout=60)
        assert process.returncode in {0, 130}, err
        assert "Traceback" not in err
        if process.returncode == 130:
            assert err.rstrip().endswith("springpot: interrupted"), err
        after = whole_files(folder)
        hidden = {item.name for item in folder.iterdir() if item.name.startswith(".")}
        assert not hidden, f"left aside: {hidden}"
        new = folder / COMMANDS[line]
        for file, content in before.items():
            assert after[file] == content or file.is_relative_to(new), file
        if "c/" not in COMMANDS[line]:
            shutil.rmtree(new) if new.is_dir() else new.unlink(missing_ok=True)
