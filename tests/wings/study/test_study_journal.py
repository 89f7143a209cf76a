"""The journal of a session: cut anywhere, damaged anywhere, opened twice."""

from pathlib import Path

import pytest

from springpot.codegen.errors import DataError, UsageError
from springpot.host.wings.study.session.journal import StudyJournal, parse_lines

STEPS = [("shown", 1), ("answered", 2.5), ("done", "ü")]


def written(file: Path) -> bytes:
    with StudyJournal(file) as journal:
        for step, value in STEPS:
            journal.write(step, value=value)
    return file.read_bytes()


def test_cut_at_every_byte_of_its_last_line(tmp_path: Path) -> None:
    whole = written(tmp_path / "j")
    begin = whole[:-1].rindex(b"\n") + 1
    for size in range(begin, len(whole)):
        (tmp_path / "j").write_bytes(whole[:size])
        reports: list[str] = []
        with StudyJournal(tmp_path / "j", reports.append) as journal:
            assert [line["step"] for line in journal.lines] == ["shown", "answered"]
            assert len(reports) == (size > begin)
            journal.write("done", value="ü")
        assert (tmp_path / "j").read_bytes() == whole


def test_every_other_damage_is_refused_or_seen(tmp_path: Path) -> None:
    whole = written(tmp_path / "j")
    last = whole[:-1].rindex(b"\n") + 1
    for at in range(last):
        damaged = bytearray(whole)
        damaged[at] ^= 1
        try:
            lines, _ = parse_lines(bytes(damaged), "j")
        except DataError as error:
            assert "damaged" in str(error)
        else:
            raise AssertionError(f"byte {at}: read as {lines}")


def test_one_process_at_a_time(tmp_path: Path) -> None:
    with StudyJournal(tmp_path / "j"), pytest.raises(UsageError, match="already runs"):
        StudyJournal(tmp_path / "j")
