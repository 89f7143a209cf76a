"""Files of recordings: bits come back, damage is never silent, and a killed writer loses nothing.

What was committed to a journal survives SIGKILL; of a flipped bit or a cut, either all samples come
back as they were, or one line says that the file is damaged. Names out of recordings become file
names: none leads out of the folder that was asked for.
"""

import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.small import press, recording

from springpot.codegen.errors import DataError, DeviceError, UsageError
from springpot.trainer.recordings import journal as journal_module
from springpot.trainer.recordings.formats.importing import import_file
from springpot.trainer.recordings.hdf5_file import write_recording
from springpot.trainer.recordings.journal import JournalWriter, journal_path, read_journal
from springpot.trainer.recordings.recording import MAX_NAME_BYTES, Recording, safe_recording_name
from springpot.trainer.recordings.recording_file import read_recording

RNG = np.random.default_rng(1)
ITEM = Recording(
    "press", np.cumsum(RNG.normal(0, 1e-5, 900)) ** 2, RNG.normal(2.0, 1.0, 900), 1e-3,
    details={"protocol": "paper", "seed": 3}, channels={"notes": np.arange(900.0)},
    session="one", start_s=2.5, place_x_m=0.01, place_y_m=-0.02,
)  # fmt: skip


def assert_same(found: Recording, wanted: Recording = ITEM) -> None:
    assert found.content_hash == wanted.content_hash
    assert {name: getattr(found, name) for name in ("name", "dt_s", "zero", "session", "start_s",
                                                   "place_m", "source")} == {
        name: getattr(wanted, name) for name in ("name", "dt_s", "zero", "session", "start_s",
                                                 "place_m", "source")}  # fmt: skip
    assert dict(found.details) == dict(wanted.details)
    for name, samples in wanted.channels.items():
        np.testing.assert_array_equal(found.channels[name], samples)


def journal_of_item(folder: Path) -> Path:
    """A journal that its writer left behind."""
    with pytest.raises(ZeroDivisionError), JournalWriter(
        folder / "press.h5", "press", 1e-3, "device", dict(ITEM.details), channels=("notes",),
        place_m=ITEM.place_m,
    ) as writer:  # fmt: skip
        for begin in range(0, 900, 50):
            rows = slice(begin, begin + 50)
            notes = ITEM.channels["notes"][rows, None]
            writer.append(ITEM.position_m[rows], ITEM.force_n[rows], notes)
        raise ZeroDivisionError
    return folder / "press.journal"


def test_a_recording_comes_back_to_the_bit(tmp_path: Path) -> None:
    write_recording(tmp_path / "press.h5", ITEM)
    assert_same(read_recording(tmp_path / "press.h5"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["press.h5"]


def test_a_finished_journal_is_a_recording_and_leaves_nothing(tmp_path: Path) -> None:
    with JournalWriter(tmp_path / "press.h5", "press", 1e-3, "device", {"a": 1}) as writer:
        writer.append(ITEM.position_m, ITEM.force_n)
        writer.finish({"b": 2}, session="one", start_s=1.0)
    found = read_recording(tmp_path / "press.h5")
    np.testing.assert_array_equal(found.force_n, ITEM.force_n)
    assert dict(found.details) == {"a": 1, "b": 2} and found.start_s == 1.0
    assert found.place_m is None
    assert sorted(path.name for path in tmp_path.iterdir()) == ["press.h5"]


def test_an_interrupted_journal_is_read_as_its_recording(tmp_path: Path) -> None:
    journal = journal_of_item(tmp_path)
    for path in (journal, tmp_path / "press.h5"):
        found = read_recording(path)
        np.testing.assert_array_equal(found.position_m, ITEM.position_m)
        np.testing.assert_array_equal(found.channels["notes"], ITEM.channels["notes"])
        assert "recovered 0.900 s" in found.details["recovered"] and found.place_m == ITEM.place_m
    with pytest.raises(UsageError, match="keeps a recording that was interrupted"):
        JournalWriter(tmp_path / "press.h5", "press", 1e-3, "device", {})


def test_a_journal_in_use_is_neither_read_nor_written(tmp_path: Path) -> None:
    with JournalWriter(tmp_path / "press.h5", "press", 1e-3, "device", {}) as writer:
        writer.append(ITEM.position_m, ITEM.force_n)
        with pytest.raises(UsageError, match="another springpot is recording it now"):
            JournalWriter(tmp_path / "press.h5", "press", 1e-3, "device", {})
        with pytest.raises(DataError, match="still being recorded"):
            read_journal(journal_path(tmp_path / "press.h5"))
        writer.discard()
    assert not list(tmp_path.iterdir())


def test_a_journal_is_in_use_from_its_first_byte_to_its_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While it is locked, and while its recording is written: another would have removed it."""
    file, met = tmp_path / "press.h5", []

    def meet(*_: object, **__: object) -> None:
        with pytest.raises(UsageError, match="another springpot is recording it now"):
            JournalWriter(file, "press", 1e-3, "device", {})
        met.append(file)

    stored = sqlite3.connect(journal_path(file))
    monkeypatch.setattr(journal_module, "sleep", lambda _: stored.execute("BEGIN EXCLUSIVE"))
    journal_path(file).touch()
    meet()
    stored.close()
    journal_path(file).unlink()
    monkeypatch.setattr(journal_module, "write_recording", meet)
    with JournalWriter(file, "press", 1e-3, "device", {}) as writer:
        writer.append(ITEM.position_m, ITEM.force_n)
        writer.finish()
    assert len(met) == 2 and not list(tmp_path.iterdir())


READER = """
import sys
from pathlib import Path
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.recording_file import read_recording
from springpot.codegen.messages import *
whole = read_recording(Path(sys.argv[1]))
for name in sys.argv[2:]:
    try:
        found = read_recording(Path(name))
    except DataError as error:
        print("refused" if str(error).startswith(name) and "\\n" not in str(error) else error)
        continue
    n = len(found.force_n)
    same = (found.position_m == whole.position_m[:n]).all() and found.dt_s == whole.dt_s
    same &= (found.force_n == whole.force_n[:n]).all() and found.name == whole.name
    lost = "damaged" in found.details.get("recovered", "")
    print("same" if same and (n == len(whole.force_n) or lost) else "SILENT")
"""


def outcomes(whole: Path, damaged: list[Path]) -> list[str]:
    """What a process of its own makes of each file: `refused`, `same`, or else."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", READER, whole, *damaged], capture_output=True,
        text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, (done.returncode, done.stderr[-400:])
    return done.stdout.splitlines()


@pytest.mark.parametrize("kind", ["recording", "journal"])
@pytest.mark.parametrize("count", [300, pytest.param(3000, marks=pytest.mark.slow)])
def test_flipped_bits_and_cuts_are_never_silent(tmp_path: Path, kind: str, count: int) -> None:
    folder = tmp_path / "damaged"
    folder.mkdir()
    if kind == "journal":
        whole = journal_of_item(tmp_path)
    else:
        whole = tmp_path / "press.h5"
        write_recording(whole, ITEM)
    content, rng = whole.read_bytes(), np.random.default_rng(2)
    files = [folder / f"{k}{whole.suffix}" for k in range(count)]
    for k, file in enumerate(files):
        changed, at = bytearray(content), int(rng.integers(len(content)))
        if k % 5 < 3:
            changed[at] ^= 1 << int(rng.integers(8))
        else:
            del changed[at:]
        file.write_bytes(changed)
    found = outcomes(whole, files)
    shutil.rmtree(folder)
    assert len(found) == count and set(found) <= {"refused", "same"}, set(found)
    assert found.count("refused") > 0.2 * count or kind == "journal"


WRITER = """
import sys, time
from pathlib import Path
import numpy as np
from springpot.trainer.recordings import journal
journal._COMMIT_S = 0.002
with journal.JournalWriter(Path(sys.argv[1]), "press", 1e-3, "device", {}) as writer:
    for k in range(100000):
        rows = np.arange(7.0 * k, 7.0 * k + 7)
        writer.append(rows, -rows)
        print(writer.committed_rows, flush=True)
"""


@pytest.mark.parametrize("count", [3, pytest.param(30, marks=pytest.mark.slow)])
def test_a_killed_writer_loses_no_row_that_was_committed(tmp_path: Path, count: int) -> None:
    for k in range(count):
        file = tmp_path / f"{k}.h5"
        writer = subprocess.Popen(
            [sys.executable, "-c", WRITER, file], stdout=subprocess.PIPE, text=True
        )
        assert writer.stdout is not None
        committed = 0
        while committed < 200 * (k % 5 + 1):
            committed = int(writer.stdout.readline())
        os.kill(writer.pid, signal.SIGKILL)
        committed = max([committed, *map(int, writer.stdout.read().split()[:-1])])
        writer.wait()
        writer.stdout.close()
        found, lost = read_journal(journal_path(file))
        assert len(found.force_n) >= committed and not lost
        np.testing.assert_array_equal(found.position_m, np.arange(len(found.force_n)))
        np.testing.assert_array_equal(found.force_n, -found.position_m)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_a_full_disk_ends_it_and_keeps_what_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("springpot.trainer.recordings.journal._COMMIT_S", 0.0)
    with pytest.raises(DeviceError, match="make room"), JournalWriter(
        tmp_path / "press.h5", "press", 1e-3, "device", {}
    ) as writer:  # fmt: skip
        writer.append(ITEM.position_m, ITEM.force_n)
        assert writer._store is not None
        pages = writer._store.execute("PRAGMA page_count").fetchone()[0]
        writer._store.execute(f"PRAGMA max_page_count = {pages + 2}")
        for _ in range(50):
            writer.append(ITEM.position_m, ITEM.force_n)
    assert writer.full
    found, _ = read_journal(tmp_path / "press.journal")
    np.testing.assert_array_equal(found.force_n[:900], ITEM.force_n)


def test_files_that_are_no_recording_are_one_line(tmp_path: Path) -> None:
    (tmp_path / "text.h5").write_text("no HDF5")
    (tmp_path / "empty.journal").touch()
    for name in ("text.h5", "empty.journal", "none.h5"):
        with pytest.raises(DataError) as error:
            read_recording(tmp_path / name)
        assert str(error.value).startswith(str(tmp_path / name)) and "\n" not in str(error.value)


HOSTILE = ["", ".", "..", "/tmp/x", "../x", "a/b", "a\\b", ".hidden", "a\nb", "\x1b[31m", "a\0b",
           "\ud800", "x" * 300, "\u202etxt", "aux", "COM1.left", "a:b"]  # fmt: skip


@pytest.mark.parametrize("name", [n for n in HOSTILE if "\0" not in n and n != "\ud800"])
def test_a_stored_name_that_is_no_file_name_is_refused(name: str, tmp_path: Path) -> None:
    """As a stranger can make it: past every check of this program."""
    file, whole = tmp_path / "sent.h5", recording("whole", press(2.0))
    object.__setattr__(whole, "name", name)
    write_recording(file, whole)
    with pytest.raises(DataError, match=r"sent\.h5: a recording named .*: name it") as why:
        read_recording(file)
    assert str(why.value).isprintable()
    with pytest.raises(DataError, match=r"sent\.h5: a recording named"):
        import_file(file)


@pytest.mark.parametrize("name", HOSTILE)
def test_no_recording_is_made_or_journalled_under_it(name: str, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="a recording named"):
        replace(recording("whole", press(2.0)), name=name)
    with pytest.raises(DataError, match="a recording named"):
        JournalWriter(tmp_path / "a.h5", name, 1e-3, "", {})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", [*HOSTILE, "Probe 3 (left)", "Gelprobe ü"])
def test_a_safe_name_is_taken_and_stays_in_its_folder(text: str, tmp_path: Path) -> None:
    named = replace(recording("whole", press(2.0)), name=safe_recording_name(text))
    write_recording(tmp_path / f"{named.name}.h5", named)
    assert [file.parent for file in tmp_path.rglob("*.h5")] == [tmp_path]
    assert len(named.name.encode()) <= MAX_NAME_BYTES
