"""The fuzzer's harnesses still read what the project writes, and keep what they find."""

import importlib
from pathlib import Path

import pytest
from proof.fuzz.harness import READERS, note_finding
from proof.fuzz.reader import PoorMessageError, Reader, refused_in_one_line

from springpot.codegen.errors import SpringpotError


@pytest.mark.slow
@pytest.mark.parametrize("name", READERS)
def test_seeds_are_read_or_refused_in_one_line(name: str, tmp_path: Path) -> None:
    reader: Reader = importlib.import_module(f"proof.fuzz.{name}_reader").READER
    read = reader.as_users or reader.read
    taken = 0
    for _, content in reader.seeds():
        try:
            read(content, tmp_path)
            taken += 1
        except SpringpotError as error:
            assert str(tmp_path) in str(error)
    assert taken >= 2


def test_a_refusal_that_names_no_file_is_a_finding(tmp_path: Path) -> None:
    def read(content: bytes, folder: Path) -> None:
        raise SpringpotError("something is wrong")

    with pytest.raises(PoorMessageError, match="does not name the file"):
        refused_in_one_line(read, b"", tmp_path)


def test_the_shortest_input_of_a_finding_is_kept(tmp_path: Path) -> None:
    for content in (b"long input", b"short", b"longer input"):
        try:
            raise ValueError("no number")
        except ValueError as error:
            note_finding(tmp_path / "findings", content, error)
    kept = sorted((tmp_path / "findings").iterdir())
    assert [file.suffix for file in kept] == [".input", ".txt"]
    assert kept[0].read_bytes() == b"short"
    assert kept[1].read_text().startswith("ValueError at ")
