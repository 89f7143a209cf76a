"""BLF logs: containers that are not compressed, so that the fuzzer reaches the frames."""

from collections.abc import Iterator
from pathlib import Path

from proof.fuzz.reader import Reader
from proof.fuzz.text_reader import read_import
from support.files.malformed import can_frames


def seeds() -> Iterator[tuple[str, bytes]]:
    """A log as python-can writes it, and the same uncompressed."""
    yield "compressed", can_frames("blf")
    yield "plain", can_frames("blf", compression_level=0)


def read(content: bytes, folder: Path) -> None:
    read_import(content, folder, "a.blf")


READER = Reader(seeds, read, words=("LOGG", "LOBJ", "\\x0a\\x00\\x00\\x00", "\\x56\\x00\\x00\\x00",
                                    "\\x64\\x00\\x00\\x00", "\\x65\\x00\\x00\\x00"))  # fmt: skip
