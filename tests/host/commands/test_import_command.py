"""`springpot import`: files in, a folder of recordings and one JSON object out."""

import json
from pathlib import Path

from click.testing import CliRunner, Result

from springpot.codegen.errors import DataError, UsageError
from springpot.host.commands.import_ import import_
from springpot.trainer.recordings.recording_file import read_recording

TABLE = "time_s,position_mm,force_N\n0.0,1,2\n0.5,2,3\n1.0,3,5\n"


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(import_, [str(argument) for argument in arguments])


def test_json(tmp_path: Path) -> None:
    (tmp_path / "a b.csv").write_text(TABLE)
    out = tmp_path / "deep" / "out"
    result = run(tmp_path / "a b.csv", "--out", out, "--zero", "first", "--json")
    assert result.exit_code == 0
    printed = json.loads(result.stdout)
    (row,) = printed["recordings"]
    assert row.pop("signs")["loops"] == 0 and row.pop("glance").startswith("stroke 2 mm, peak 3 N")
    assert row == {
        "name": "a_b", "file": str(out / "a_b.h5"), "samples": 3, "rate_hz": 2.0,
        "position_m": [0.0, 0.002], "force_n": [0.0, 3.0],
    }  # fmt: skip
    assert "column 2 'position_mm' in mm" in printed["guess"] and printed["guess"] in result.stderr
    assert [str(file.parent) for file in out.iterdir()] == [printed["out"]]
    assert read_recording(out / "a_b.h5").zero == "first"


def test_a_recording_can_be_conditioned_again(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(TABLE)
    run(tmp_path / "a.csv", "--out", tmp_path / "out")
    again = run(tmp_path / "out" / "a.h5", "--tare", "0.5", "--out", tmp_path / "again")
    assert again.exit_code == 0, again.exception
    assert read_recording(tmp_path / "again" / "a.h5").force_n.tolist() == [1.5, 2.5, 4.5]
    mapped = run(tmp_path / "out" / "a.h5", "--zero", "min", "--out", tmp_path / "no")
    assert isinstance(mapped.exception, UsageError)


def test_nothing_is_written_or_overwritten_when_one_file_is_refused(tmp_path: Path) -> None:
    good, bad, out = tmp_path / "a.csv", tmp_path / "b.csv", tmp_path / "out"
    good.write_text(TABLE)
    bad.write_text(TABLE.replace("3,5", "3,x"))
    result = run(good, bad, "--out", out)
    assert isinstance(result.exception, DataError)
    assert "b.csv, row 4, column 3" in str(result.exception) and not out.exists()
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "a.csv").write_text(TABLE)
    assert isinstance(run(good, tmp_path / "x" / "a.csv", "--out", out).exception, UsageError)
    assert not out.exists()  # for two files of one name
    bad.write_text(TABLE)
    run(bad, "--out", out)
    before, result = (out / "b.h5").read_bytes(), run(good, bad, "--zero", "min", "--out", out)
    assert isinstance(result.exception, UsageError)
    assert "b.h5: exists already" in str(result.exception)
    assert [file.read_bytes() for file in out.iterdir()] == [before]


def test_a_folder_is_the_files_in_it(tmp_path: Path) -> None:
    folder = tmp_path / "rig"
    (folder / "older").mkdir(parents=True)
    empty = run(folder, "--out", tmp_path / "out")
    assert "rig: no file in this folder ends in .asc" in str(empty.exception)
    for name in ("b.csv", "a.CSV", "older/c.csv"):
        (folder / name).write_text(TABLE)
    for name in ("notes.md", "LICENSE.txt", "README", "rig.json"):
        (folder / name).write_text("No recording, as of 3, 5 or 7 May 2026,\n1.2, no warranty\n")
    (tmp_path / "d.csv").write_text(TABLE)
    found = run(folder, tmp_path / "d.csv", "--out", tmp_path / "out")
    assert found.exit_code == 0, found.exception
    assert "left out, no recordings: README, notes.md, rig.json\n" in found.stderr
    assert f"left out, no recording: {folder / 'LICENSE.txt'}: found no column" in found.stderr
    assert found.stderr.count("time = column 1") == 1
    assert "a.CSV and 2 more: time = column 1" in found.stderr
    assert found.stdout.count("position grows into the object") <= 1
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a.h5", "b.h5", "d.h5"]
