"""A file format: how its files begin, and the one signature of all readers."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path

from springpot.codegen.entry_points import blaming, registered
from springpot.codegen.errors import DataError
from springpot.codegen.short_repr import short_repr
from springpot.trainer.recordings.formats.column_map import ColumnMap
from springpot.trainer.recordings.formats.csv.decimals import DecimalMark
from springpot.trainer.recordings.formats.raw_channels import RawChannels

START_BYTES = 520  # of a file, which `begins` sees; a user block of HDF5 is 512 of them


@dataclass(frozen=True)
class FileRequest:
    """What a reader is asked for, besides the path.

    columns: of each channel, "time", "position" or "force", the column, signal or array and its
    unit; what it leaves out is guessed, and without --map it is empty. dbc: database of a CAN log.
    block: only blocks of this kind of a Mach-1 file. decimal: mark of decimals in text, None:
    guessed. resampled: samples are interpolated afterwards. place: headers of two columns, where
    the object is pressed. A reader of a format without columns to choose refuses them with
    UsageError; other settings it may pass over.
    """

    columns: ColumnMap = field(default_factory=dict)
    dbc: Path | None = None
    block: str | None = None
    decimal: DecimalMark | None = None
    resampled: bool = False
    place: tuple[str, str] | None = None
    __repr__ = short_repr


Reader = Callable[[Path, FileRequest], tuple[list[RawChannels], str]]


@dataclass(frozen=True)
class FileFormat:
    """One kind of file.

    title: in lists. begins: whether a file's first START_BYTES bytes are of this format.
    reads: "module:name" of a Reader, or itself: it returns the recordings, in SI units and
    unchecked, and one line that says how it understood the file, or raises DataError naming file
    and row. place: the order in which formats are asked; text without any mark is asked last.
    """

    title: str
    begins: Callable[[bytes], bool]
    reads: str | Reader
    place: int = 100
    __repr__ = short_repr

    def fits(self, path: Path, start: bytes) -> bool:
        """Return whether a file begins as this format does. Raises DataError if asking fails."""
        with blaming(f"{path}: asking for the format {self.title!r}", self.begins, DataError):
            return self.begins(start)

    def read(self, path: Path, request: FileRequest) -> tuple[list[RawChannels], str]:
        """Read a file of this format, as `reads` says. Raises DataError if reading fails."""
        with blaming(f"{path}: reading the format {self.title!r}", self.reads, DataError):
            found = self._reader()(path, request)
            match found:
                case ([RawChannels(), *_], str()):
                    return found
            raise TypeError("its reader returns no (list of RawChannels, line of text)")

    def _reader(self) -> Reader:
        if not isinstance(self.reads, str):
            return self.reads
        module, _, name = self.reads.partition(":")
        reader: Reader = getattr(import_module(module), name)
        return reader


CSV = FileFormat(  # of any text: asked last
    "CSV", lambda start: True, "springpot.trainer.recordings.formats.csv.csv_text:read_csv", 1000
)


@cache
def file_formats() -> dict[str, FileFormat]:
    """Return all formats in the order in which they are asked: the group springpot.formats."""
    return registered("formats", FileFormat)
