"""Files of recordings: HDF5, a 1-D data set a channel, or the journal that a crash left of one.

The SHA-256 of an HDF5 file stands in its user block, which HDF5 readers skip, and is compared
before the library reads: on a flipped byte that can hang, whatever checksums its own format has
(tried with those of HDF5 1.10: 1 of some 3 000 flips did not end). A journal, of SQLite, survives
what HDF5 does not: see `JournalWriter`.
"""

import hashlib
import json
import sqlite3
import zlib
from collections.abc import Iterable, Mapping
from contextlib import closing, suppress
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from pydantic import BaseModel, Field, ValidationError

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import given_path, require_regular, written_aside
from springpot.codegen.messages import caution
from springpot.trainer.recordings.recording import (
    RECORDING_SUFFIX,
    SIGN_RULE,
    Recording,
    Zero,
    require_recording_name,
)

File = str | PathLike[str]
Recordings = Recording | File | Iterable[Recording | File]  # what a person may give

RECORDING_SCHEMA = 1
JOURNAL_SUFFIX = ".journal"
MIN_SAMPLES = 2  # fewer are no recording
_UNITS = {"position_m": "m", "force_n": "N"}
_MORE = "channels/"  # group of the channels beside these two
_CHUNK_SAMPLES = 1 << 17
_USER_BLOCK = 512  # bytes
_MAGIC = b"springpot recording, SHA-256 of what follows: "
_REMEDY = "make one with `springpot import`"
_GIVE = "give a recording; `springpot import` makes them"


def given_recordings(given: Recordings) -> list[Recording]:
    """One recording or several; text and paths are files or folders of them. Raises UsageError."""
    several = [given] if isinstance(given, Recording | str | PathLike) else given
    found: list[Recording] = []
    # The items of a table are names of its columns, those of an array its rows.
    if isinstance(several, Mapping) or not isinstance(several, Iterable):
        raise _no_recording(given)
    for one in [given] if hasattr(several, "columns") or hasattr(several, "shape") else several:
        if isinstance(one, Recording):
            found.append(one)
        elif isinstance(one, str | PathLike):
            found += read_recordings([given_path(one)])
        else:
            raise _no_recording(one)
    return found


def _no_recording(given: object) -> UsageError:
    remedy = "read_recordings reads files and folders"
    if isinstance(given, Mapping) and all(isinstance(one, Recording) for one in given.values()):
        remedy = "give a list of them, list(recordings.values())"
    elif isinstance(given, Mapping) or hasattr(given, "columns"):
        remedy = "Recording.from_frame makes one of a table"
    elif hasattr(given, "shape"):
        remedy = "Recording(name, position_m, force_n, dt_s) makes one"
    return UsageError(f"{type(given).__name__} is no recording: {remedy}")


def read_recording(path: Path) -> Recording:
    """Read one recording, or recover what a crash left of it and say so.

    path: an HDF5 file, or a journal. Raises DataError with the file's name if it cannot be used.
    """
    journal = journal_of(path)
    if path.suffix == JOURNAL_SUFFIX or (not path.exists() and journal.exists()):
        found, lost = read_journal(journal)
        message = (
            f"recovered {found.duration_s:.3f} s from the journal of a recording that was "
            f"interrupted{lost}"
        )
        caution(f"{journal}: {message}")
        return replace(found, details={**found.details, "recovered": message})
    try:
        require_regular(path)
        return read_hdf5(path)
    except FileNotFoundError:
        raise DataError(f"{path}: no such file: {_GIVE}") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}): {_GIVE}") from None


def read_recordings(paths: Iterable[Path]) -> list[Recording]:
    """Read files and folders of recordings, folders in the order of their files' names.

    Journals that a crash left in a folder are recovered. Raises DataError for an empty folder.
    """
    files: list[Path] = []
    for path in paths:
        files += _in_folder(path) if path.is_dir() else [path]
    return [read_recording(file) for file in files]


def _in_folder(folder: Path) -> list[Path]:
    files = list(folder.glob(f"*{RECORDING_SUFFIX}"))
    for journal in folder.glob(f"*{JOURNAL_SUFFIX}"):
        finished = journal.with_suffix(RECORDING_SUFFIX)
        if finished in files:
            caution(f"{journal}: left out, {finished.name} is this recording, finished: remove it")
        else:
            files.append(journal)
    if not files:
        raise DataError(
            f"{folder}: no {RECORDING_SUFFIX} file in this folder: `springpot import` makes them"
        )
    return sorted(files)


class _Metadata(BaseModel, allow_inf_nan=False):
    """Fields of `Recording` beside its samples, as they are stored."""

    name: str
    dt_s: float = Field(gt=0)
    source: str
    details: dict[str, Any]
    zero: Zero = "none"
    position_delay_s: float = 0.0
    force_delay_s: float = 0.0
    session: str = ""
    start_s: float | None = None
    place_x_m: float | None = None
    place_y_m: float | None = None


def write_recording(path: Path, recording: Recording, *, overwrite: bool = True) -> None:
    """Write a recording aside, sync and rename it to `path`: a reader never sees half a file.

    overwrite: False raises FileExistsError if `path` exists, even if it came meanwhile.
    Raises OSError, and leaves nothing aside, if that fails.
    """
    with written_aside(path, overwrite=overwrite, durable=True) as aside:
        with h5py.File(aside, "w", track_order=True, userblock_size=_USER_BLOCK) as file:
            metadata = {name: getattr(recording, name) for name in _Metadata.model_fields}
            # HDF5 holds UTF-8: of a path that is none, the bytes as \xff, for people.
            metadata["source"] = recording.source.encode("utf-8", "backslashreplace").decode()
            metadata["details"] = json.dumps(dict(recording.details), sort_keys=True)
            metadata |= {"schema": RECORDING_SCHEMA, "sign_rule": SIGN_RULE}
            for key, value in metadata.items():
                if value is not None:
                    file.attrs[key] = value
            further = {f"{_MORE}{name}": its for name, its in recording.channels.items()}
            channels = {"position_m": recording.position_m, "force_n": recording.force_n}
            for name, samples in {**channels, **further}.items():
                stored = file.create_dataset(
                    name, data=samples, chunks=(min(len(samples), _CHUNK_SAMPLES),),
                    compression="gzip", compression_opts=1, shuffle=True, fletcher32=True,
                )  # fmt: skip
                if name in _UNITS:
                    stored.attrs["unit"] = _UNITS[name]
        digest = _digest(aside)
        with aside.open("r+b") as raw:
            raw.write(_MAGIC + digest + b"\n")


def is_recording(path: Path) -> bool:
    """Return whether a file begins as a recording of springpot's."""
    with path.open("rb") as file:
        return file.read(len(_MAGIC)) == _MAGIC


def read_hdf5(path: Path) -> Recording:
    """Read a recording. Raises DataError for a file that is damaged, or none."""
    with path.open("rb") as raw:
        head = raw.read(_USER_BLOCK)
    if not head.startswith(_MAGIC):
        raise DataError(f"{path}: not a springpot recording: {_REMEDY}")
    if head[len(_MAGIC) :].rstrip(b"\0\n") != _digest(path):
        raise DataError(f"{path}: damaged, its bytes differ from those written: import it again")
    try:
        with h5py.File(path, "r") as file:
            metadata = dict(file.attrs)
            names = [*_UNITS, *(f"{_MORE}{name}" for name in file.get(_MORE, ()))]
            samples = {n.removeprefix(_MORE): np.asarray(file[n], dtype=np.float64) for n in names}
    # The library raises whatever it meets in a file that others have made.
    except (OSError, KeyError, TypeError, ValueError, RuntimeError, AttributeError) as error:
        reason = " ".join(str(error).split())
        raise DataError(f"{path}: not a springpot recording ({reason}): {_REMEDY}") from None
    metadata["details"] = metadata_of_json(path, metadata.get("details", ""))
    return recording_of(path, metadata, samples)


def _digest(path: Path) -> bytes:
    with path.open("rb") as file:
        file.seek(_USER_BLOCK)
        return hashlib.file_digest(file, "sha256").hexdigest().encode()


def metadata_of_json(path: Path, text: str | bytes) -> dict[str, Any]:
    """Parse a table of JSON. Raises DataError for anything else."""
    try:
        found = json.loads(text)
    except (ValueError, TypeError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise DataError(f"{path}: not a springpot recording (metadata is no JSON): {_REMEDY}")
    return found


def recording_of(
    path: Path, metadata: Mapping[str, Any], samples: Mapping[str, Samples]
) -> Recording:
    """Return the recording of stored metadata and samples, each (n,), of a file.

    Raises DataError for a field that is missing or of another type, and for a later schema.
    """
    plain = {k: v.item() if isinstance(v, np.generic) else v for k, v in metadata.items()}
    schema = plain.get("schema")
    if isinstance(schema, int) and schema > RECORDING_SCHEMA:
        raise DataError(
            f"{path}: recording schema {schema}, this springpot reads up to {RECORDING_SCHEMA}: "
            "upgrade springpot"
        )
    try:
        found = _Metadata.model_validate(plain)
    except ValidationError as error:
        first = error.errors()[0]
        what = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        raise DataError(f"{path}: not a springpot recording ({what}): {_REMEDY}") from None
    require_recording_name(found.name, f"{path}: ")
    fields: dict[str, Any] = {**found.model_dump(), **{name: samples[name] for name in _UNITS}}
    channels = {name: its for name, its in samples.items() if name not in _UNITS}
    try:
        return Recording(**fields, channels=channels)
    except DataError as error:
        raise DataError(f"{path}: {error}") from None


def journal_of(file: Path) -> Path:
    """Path of the journal of the recording `file`."""
    stem = file.name.removesuffix(RECORDING_SUFFIX).removesuffix(JOURNAL_SUFFIX)
    return file.with_name(stem + JOURNAL_SUFFIX)


def _opened(journal: Path, timeout_s: float) -> closing[sqlite3.Connection]:
    """Open a journal that is there, and close it at the end of a `with`."""
    uri = f"{journal.absolute().as_uri()}?mode=rw"
    return closing(sqlite3.connect(uri, uri=True, timeout=timeout_s))


def is_being_recorded(journal: Path) -> bool:
    """Return whether a living process still writes this journal."""
    try:
        with _opened(journal, timeout_s=0.0) as store:
            store.execute("BEGIN IMMEDIATE")
    except sqlite3.DatabaseError as error:
        return "locked" in str(error)
    return False


def require_no_journal(journal: Path) -> None:
    """Raise UsageError for a journal that is there: it is recorded now, or was interrupted."""
    if not journal.exists():
        return
    remedy = "choose another name or folder"
    if is_being_recorded(journal):
        raise UsageError(f"{journal}: another springpot is recording it now: {remedy}")
    raise UsageError(
        f"{journal}: keeps a recording that was interrupted: {remedy}, or remove it; `springpot "
        "import` makes a recording of it"
    )


def read_journal(path: Path) -> tuple[Recording, str]:
    """Return the recording that a journal holds, and what is lost of it, in a line or "".

    Raises DataError for one without samples, or one that is still being recorded.
    """
    if not path.exists():
        raise DataError(f"{path}: no such file: {_GIVE}")
    if is_being_recorded(path):
        raise DataError(f"{path}: still being recorded: wait until that ends")
    parts, damaged = _whole_parts(path)
    if not parts:
        raise DataError(
            f"{path}: damaged in its first bytes, or interrupted at the very start: without its "
            "rate and name nothing can be read, remove it"
        )
    metadata = metadata_of_json(path, parts[0])
    try:
        names = ["position_m", "force_n", *map(str, metadata.get("channels", ()))]
        rows = np.frombuffer(b"".join(parts[1:]), dtype="<f8").reshape(-1, len(names))
    except (TypeError, ValueError):
        raise DataError(f"{path}: its rows are not those of its channels: remove it") from None
    if len(rows) < MIN_SAMPLES:
        raise DataError(f"{path}: interrupted before its first samples: remove it")
    columns = [np.ascontiguousarray(column, dtype=np.float64) for column in rows.T]
    recording = recording_of(path, metadata, dict(zip(names, columns, strict=True)))
    lost = f"; from {recording.duration_s:.3f} s on it is damaged, and lost" if damaged else ""
    return recording, lost


def _whole_parts(path: Path) -> tuple[list[bytes], bool]:
    """Content of the parts up to the first that is damaged or missing, and whether one is."""
    parts: list[bytes] = []
    with suppress(sqlite3.DatabaseError, OverflowError), _opened(path, timeout_s=5.0) as store:
        for number, checksum, content in store.execute(
            "SELECT id, checksum, content FROM part ORDER BY id"
        ):
            whole = isinstance(content, bytes) and checksum == zlib.crc32(content, len(parts))
            if number != len(parts) or not whole:
                return parts, True
            parts.append(content)
        return parts, False
    return parts, True
