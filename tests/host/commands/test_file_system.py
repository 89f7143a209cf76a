"""Files that a command line meets: their names and kinds, and a disk that fills up in a write."""

import os
import resource
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from support.in_process import spring
from support.peer import CLI

ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
ROWS = "".join(f"{k / 100},{k % 7},{k % 7}\n" for k in range(400))
TABLE = f"time_s,position_mm,force_N\n{ROWS}"


def springpot(*arguments: bytes | str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*CLI, *arguments], capture_output=True, text=True, errors="replace", check=False,
        timeout=100, env={**os.environ, **environment},
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("locale", [{}, ASCII])
@pytest.mark.parametrize("name", [b"gel\xff\xfe.csv", "gelä→.csv".encode()])
def test_any_file_name_is_imported(name: bytes, locale: dict[str, str], tmp_path: Path) -> None:
    file = os.fsencode(tmp_path) + b"/" + name
    Path(os.fsdecode(file)).write_text(TABLE)
    done = springpot("import", file, "--out", str(tmp_path / "out"), **locale)
    assert "Traceback" not in done.stderr
    assert done.returncode == 0, done.stderr
    missing = springpot("check", file + b"x", **locale)
    assert (missing.returncode, "Traceback" in missing.stderr) == (3, False), missing.stderr


@pytest.mark.few(1)
@pytest.mark.parametrize("command", ["import", "check"])
def test_a_pipe_or_device_is_refused_at_once(command: str, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    out = ["--out", str(tmp_path / "out")] if command == "import" else []
    for file in (str(pipe), "/dev/zero"):
        done = springpot(command, file, *out)
        assert done.returncode == 3
        assert "a pipe or device, not a file" in done.stderr


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
def validated(job: Path) -> Path:
    done = spring("validate", job / "c", "--recording", job / "rec")
    assert done.returncode == 0, done.stderr
    return job


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "arguments",
    [
        ["train", "rec", "--model", "rf-fd", "--out", "model.spm"],
        ["emit", "--scene", "scene.toml", "--out", "c"],
        ["validate", "c", "--recording", "rec"],
        ["report", "c"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_nothing_is_left_and_what_was_there_stands(
    arguments: list[str], validated: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(validated, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    before = content(tmp_path)
    with files_of_at_most(1000):
        done = spring(*arguments)
    assert done.returncode == 2, done.stderr
    assert "choose another " in done.stderr.splitlines()[-1]
    assert content(tmp_path) == before
