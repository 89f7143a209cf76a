"""`springpot import`: files in, a folder of recordings and one JSON object out."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from springpot.host.import_command import import_
from springpot.runtime_c.errors import DataError, UsageError
from springpot.trainer.recording_file import read_recording

TABLE = "time_s,position_mm,force_N\n0.0,1,2\n0.5,2,3\n1.0,3,5\n"


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(import_, [str(argument) for argument in arguments])


def test_json(tmp_path: Path) -> None:
    (tmp_path / "a b.csv").write_text(TABLE)
    out = tmp_path / "deep" / "out"
    result = run(tmp_path / "a b.csv", "--out", out, "--zero", "first", "--json")
    assert result.exit_code == 0
    printed = json.loads(result.stdout)
    assert printed["out"] == str(out)
    assert printed["recordings"] == [
        {
            "name": "a_b",
            "file": str(out / "a_b.h5"),
            "samples": 3,
            "rate_hz": 2.0,
            "position_m": [0.0, 0.002],
            "force_n": [0.0, 3.0],
        }
    ]
    assert "column 2 'position_mm' in mm" in printed["guess"]
    assert printed["guess"] in result.stderr
    assert [file.name for file in out.iterdir()] == ["a_b.h5"]
    assert read_recording(out / "a_b.h5").zero == "first"


def test_without_json_one_line_a_recording(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(TABLE)
    result = run(tmp_path / "a.csv", "--out", tmp_path / "out")
    assert "a.h5  3 samples at 2 Hz, 1 to 3 mm, 2 to 5 N" in result.stdout


def test_nothing_is_written_when_one_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(TABLE)
    (tmp_path / "b.csv").write_text(TABLE.replace("3,5", "3,x"))
    result = run(tmp_path / "a.csv", tmp_path / "b.csv", "--out", tmp_path / "out")
    assert isinstance(result.exception, DataError)
    assert "b.csv, row 4, column 3" in str(result.exception)
    assert not (tmp_path / "out").exists()


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(TABLE)
    (tmp_path / "b.csv").write_text(TABLE)
    run(tmp_path / "b.csv", "--out", tmp_path / "out")
    before = (tmp_path / "out" / "b.h5").read_bytes()
    result = run(tmp_path / "a.csv", tmp_path / "b.csv", "--zero", "min", "--out", tmp_path / "out")
    assert isinstance(result.exception, UsageError)
    assert "b.h5: exists already" in str(result.exception)
    assert (tmp_path / "out" / "b.h5").read_bytes() == before
    assert not (tmp_path / "out" / "a.h5").exists()


def test_two_files_of_one_name_are_refused(tmp_path: Path) -> None:
    for folder in ("x", "y"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "a.csv").write_text(TABLE)
    result = run(tmp_path / "x" / "a.csv", tmp_path / "y" / "a.csv", "--out", tmp_path / "out")
    assert isinstance(result.exception, UsageError)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "arguments",
    [["--zero", "last"], ["--resample-hz", "0"], ["--resample-hz", "nan"], ["--map", "x"]],
)
def test_wrong_use(tmp_path: Path, arguments: list[str]) -> None:
    (tmp_path / "a.csv").write_text(TABLE)
    result = run(tmp_path / "a.csv", "--out", tmp_path / "out", *arguments)
    assert getattr(result.exception, "exit_status", result.exit_code) == 2


def test_a_missing_file_or_an_out_that_is_a_file(tmp_path: Path) -> None:
    missing = run(tmp_path / "none.csv", "--out", tmp_path / "out")
    assert "none.csv: No such file" in str(missing.exception)
    (tmp_path / "a.csv").write_text(TABLE)
    blocked = run(tmp_path / "a.csv", "--out", tmp_path / "a.csv")
    assert isinstance(blocked.exception, UsageError)
