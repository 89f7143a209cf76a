"""Names out of recordings become file names: none leads out of the folder that was asked for."""

from dataclasses import replace
from pathlib import Path

import pytest
from support.small import press, recording

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.importing import import_file
from springpot.trainer.recordings.journal import JournalWriter
from springpot.trainer.recordings.recording import MAX_NAME_BYTES, safe_recording_name
from springpot.trainer.recordings.recording_file import read_recording, write_recording

HOSTILE = ["", ".", "..", "/tmp/x", "../x", "a/b", "a\\b", ".hidden", "a\nb", "\x1b[31m", "a\0b",
           "\ud800", "x" * 300, "\u202etxt"]  # fmt: skip


def _recording_named(name: str, path: Path) -> None:
    """A recording as a stranger can make it: past every check of this program."""
    whole = recording("whole", press(2.0))
    object.__setattr__(whole, "name", name)
    write_recording(path, whole)


@pytest.mark.parametrize("name", [n for n in HOSTILE if "\0" not in n and n != "\ud800"])
def test_a_stored_name_that_is_no_file_name_is_refused(name: str, tmp_path: Path) -> None:
    file = tmp_path / "sent.h5"
    _recording_named(name, file)
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
