"""Names and kinds of input files that a command line meets: no traceback, no waiting for ever."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
ROWS = "".join(f"{k / 100},{k % 7},{k % 7}\n" for k in range(400))
TABLE = f"time_s,position_mm,force_N\n{ROWS}"


def springpot(*arguments: bytes | str, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from springpot.host.cli import main; main()", *arguments]
    return subprocess.run(
        command, capture_output=True, text=True, errors="replace", check=False, timeout=100,
        env={**os.environ, **environment},
    )  # fmt: skip


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


@pytest.mark.parametrize("command", ["import", "check"])
def test_a_pipe_or_device_is_refused_at_once(command: str, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    out = ["--out", str(tmp_path / "out")] if command == "import" else []
    for file in (str(pipe), "/dev/zero"):
        done = springpot(command, file, *out)
        assert done.returncode == 3
        assert "a pipe or device, not a file" in done.stderr


def test_doctor_shows_the_whole_path_of_the_cache(tmp_path: Path) -> None:
    folder = tmp_path / ("long" * 30)
    done = springpot("doctor", XDG_CACHE_HOME=str(folder), COLUMNS="80")
    assert "\u2026" not in done.stdout
    assert "".join(done.stdout.split()).count("long") >= 30
