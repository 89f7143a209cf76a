"""Recording without losing anything: an SQLite journal, and an HDF5 file only at the end.

HDF5 survives neither SIGKILL nor a full disk. SQLite does: all that was committed is there at the
next read; the rest, at most half a second, is lost.
"""

import json
import os
import sqlite3
import zlib
from collections.abc import Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path
from time import perf_counter, sleep
from typing import Any, Self

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError, DeviceError, UsageError
from springpot.codegen.messages import caution
from springpot.trainer.recordings.hdf5_file import (
    RECORDING_SCHEMA,
    build_recording,
    parse_metadata,
    write_recording,
)
from springpot.trainer.recordings.recording import (
    RECORDING_SUFFIX,
    Recording,
    Zero,
    require_recording_name,
)

JOURNAL_SUFFIX = ".journal"
MIN_SAMPLES = 2  # fewer are no recording
_COMMIT_S = 0.5  # of wall clock between two commits: what a crash may take
_LOCK_S = 0.2  # of wall clock from making a journal to locking it: a thousand times what it takes
_REMEDY = "choose another name or folder"
_SCHEMA = """
PRAGMA locking_mode = EXCLUSIVE;
CREATE TABLE part (id INTEGER PRIMARY KEY, checksum INTEGER NOT NULL, content BLOB NOT NULL);
"""  # part 0: metadata as JSON; from 1 on rows of float64: position, force, further channels


def journal_path(file: Path) -> Path:
    """Path of the journal of the recording `file`."""
    stem = file.name.removesuffix(RECORDING_SUFFIX).removesuffix(JOURNAL_SUFFIX)
    return file.with_name(stem + JOURNAL_SUFFIX)


def _open(journal: Path, timeout_s: float) -> closing[sqlite3.Connection]:
    """Open a journal that is there, and close it at the end of a `with`."""
    uri = f"{journal.absolute().as_uri()}?mode=rw"
    return closing(sqlite3.connect(uri, uri=True, timeout=timeout_s))


def is_being_recorded(journal: Path) -> bool:
    """Return whether a living process still writes this journal."""
    for wait_s in (_LOCK_S, 0.0):
        try:
            with _open(journal, timeout_s=0.0) as store:
                store.execute("BEGIN IMMEDIATE")
            if journal.stat().st_size:
                break
        except (sqlite3.DatabaseError, FileNotFoundError) as error:
            return "locked" in str(error)
        sleep(wait_s)  # an empty file may have been made a moment ago, and be locked in the next
    return False


def require_no_journal(journal: Path) -> None:
    """Raise UsageError for a journal that is there: it is recorded now, or was interrupted."""
    if is_being_recorded(journal):
        raise _recorded_now(journal)
    if journal.exists():
        raise UsageError(
            f"{journal}: keeps a recording that was interrupted: {_REMEDY}, or remove it; "
            "`springpot import` makes a recording of it"
        )


def _recorded_now(journal: Path) -> UsageError:
    return UsageError(f"{journal}: another springpot is recording it now: {_REMEDY}")


class JournalWriter:
    """Write one recording as it is made; `finish` turns it into an HDF5 file.

    Use it as a context manager: where it is left by an error, what was recorded stays in the
    journal, and one line reports it. Where nothing was recorded, no journal is left.
    """

    def __init__(
        self,
        file: Path,
        name: str,
        dt_s: float,
        source: str,
        details: Mapping[str, Any],
        *,
        zero: Zero = "none",
        channels: Sequence[str] = (),
        place_m: tuple[float, float] | None = None,
    ) -> None:
        """file: of the recording at the end. Raises UsageError where it, or a journal, is there."""
        require_recording_name(name)
        self.file, self.journal = file, journal_path(file)
        if file.exists():
            raise UsageError(f"{file}: exists and is not overwritten: give another name")
        require_no_journal(self.journal)
        self.full = False
        self.committed_rows = 0  # that survive whatever happens to this process
        self._width = 2 + len(channels)
        self.rows, self._parts, self._committed_s = 0, 0, perf_counter()
        self._store: sqlite3.Connection | None = None
        metadata = {
            "schema": RECORDING_SCHEMA, "name": name, "dt_s": dt_s, "source": source,
            "zero": zero, "details": dict(details), "channels": list(channels),
        }  # fmt: skip
        if place_m is not None:
            metadata["place_x_m"], metadata["place_y_m"] = place_m
        try:
            self._store = sqlite3.connect(self.journal, check_same_thread=False)
            self._store.executescript(_SCHEMA)
        except sqlite3.Error as error:
            if is_being_recorded(self.journal):  # since the line above
                raise _recorded_now(self.journal) from None
            raise UsageError(f"{self.journal}: {error}: give another folder") from None
        self._write(json.dumps(metadata).encode())
        self._commit()

    def append(
        self, position_m: Samples, force_n: Samples, channels: Samples | None = None
    ) -> None:
        """Take the next samples, each shape (n,). Raises DeviceError where the disk is full.

        channels: shape (n, k), a column for each channel beside them.
        """
        if not len(position_m):
            return
        rows = np.empty((len(position_m), self._width), dtype="<f8")
        rows[:, 0], rows[:, 1] = position_m, force_n
        if channels is not None:
            rows[:, 2:] = channels
        self._write(rows.tobytes())
        self.rows += len(rows)
        if perf_counter() - self._committed_s > _COMMIT_S:
            self._commit()

    def finish(
        self,
        details: Mapping[str, Any] | None = None,
        session: str = "",
        start_s: float | None = None,
    ) -> None:
        """Write the HDF5 file aside, sync it, rename it, and only then remove the journal.

        details: what became known since the start, added to the recording's; session, start_s: as
        in `Recording`.
        Raises DeviceError where there is no room for it; the journal then stays and is readable.
        """
        self._commit()
        assert self._store is not None, "the journal is closed"
        # Locked until its file is there: another process would take it for an interrupted one.
        recording, _ = _build(self.journal, *_read_parts(self._store))
        metadata = {**recording.details, **(details or {})}
        whole = replace(recording, details=metadata, session=session, start_s=start_s)
        try:
            write_recording(self.file, whole, overwrite=False)
            if os.name == "nt":  # which removes no open file
                self._close()
            self.journal.unlink()
        except FileExistsError:
            raise UsageError(
                f"{self.file}: another program wrote it meanwhile; this recording is kept in "
                f"{self.journal}: move one of them away"
            ) from None
        except OSError as error:
            raise self._failure(error) from None
        finally:
            self._close()

    def discard(self) -> None:
        """Remove the journal of a recording that never began."""
        self._close()
        self.journal.unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        """Keep what was recorded if the recording was not finished, and say where."""
        if self._store is None:
            return
        if self.rows < MIN_SAMPLES:
            self.discard()
            return
        with suppress(DeviceError):  # the error that is under way is reported instead
            self._commit()
        self._close()
        caution(f"{self.journal}: what was recorded until now is kept there and can be read")

    def _write(self, content: bytes) -> None:
        checksum = zlib.crc32(content, self._parts)
        self._execute("INSERT INTO part VALUES (?, ?, ?)", (self._parts, checksum, content))
        self._parts += 1

    def _commit(self) -> None:
        if not self.full and self._store is not None:
            if self._store.in_transaction:
                self._execute("COMMIT")
            self.committed_rows, self._committed_s = self.rows, perf_counter()

    def _execute(self, statement: str, values: tuple[object, ...] = ()) -> None:
        assert self._store is not None, "the journal is closed"
        try:
            self._store.execute(statement, values)
        except sqlite3.Error as error:
            self.full = True
            raise self._failure(error) from None

    def _failure(self, error: Exception) -> DeviceError:
        reason = getattr(error, "strerror", None) or error
        return DeviceError(
            f"{self.file}: cannot go on writing ({reason}), recording stopped: make room; "
            f"{self.journal.name} holds what was recorded and can be read"
        )

    def _close(self) -> None:
        # Forgotten first: Ctrl-C may come while it closes, and `__exit__` must not use it again.
        store, self._store = self._store, None
        if store is not None:
            store.close()


def read_journal(path: Path) -> tuple[Recording, str]:
    """Return the recording that a journal holds, and what is lost of it, in a line or "".

    Raises DataError for one without samples, or one that is still being recorded.
    """
    if is_being_recorded(path):
        raise DataError(f"{path}: still being recorded: wait until that ends")
    try:
        with _open(path, timeout_s=5.0) as store:
            return _build(path, *_read_parts(store))
    except sqlite3.DatabaseError:
        return _build(path, [], True)


def _build(path: Path, parts: list[bytes], damaged: bool) -> tuple[Recording, str]:
    """Build the recording of a journal's parts; see `read_journal`."""
    if not parts:
        raise DataError(
            f"{path}: damaged in its first bytes, or interrupted at the very start: without its "
            "rate and name nothing can be read, remove it"
        )
    metadata = parse_metadata(path, parts[0])
    try:
        names = ["position_m", "force_n", *map(str, metadata.get("channels", ()))]
        rows = np.frombuffer(b"".join(parts[1:]), dtype="<f8").reshape(-1, len(names))
    except (TypeError, ValueError):
        raise DataError(f"{path}: its rows are not those of its channels: remove it") from None
    if len(rows) < MIN_SAMPLES:
        raise DataError(f"{path}: interrupted before its first samples: remove it")
    columns = [np.ascontiguousarray(column, dtype=np.float64) for column in rows.T]
    recording = build_recording(path, metadata, dict(zip(names, columns, strict=True)))
    lost = f"; from {recording.duration_s:.3f} s on it is damaged, and lost" if damaged else ""
    return recording, lost


def _read_parts(store: sqlite3.Connection) -> tuple[list[bytes], bool]:
    """Content of the parts up to the first that is damaged or missing, and whether one is."""
    parts: list[bytes] = []
    with suppress(sqlite3.DatabaseError, OverflowError):
        for number, checksum, content in store.execute(
            "SELECT id, checksum, content FROM part ORDER BY id"
        ):
            whole = isinstance(content, bytes) and checksum == zlib.crc32(content, len(parts))
            if number != len(parts) or not whole:
                return parts, True
            parts.append(content)
        return parts, False
    return parts, True
