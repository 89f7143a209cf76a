"""Recording without losing anything: an SQLite journal, and an HDF5 file only at the end.

HDF5 survives neither SIGKILL nor a full disk. SQLite does: what was committed is there at the next
read, short of what was not yet written, at most half a second.
"""

import json
import sqlite3
import zlib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from time import monotonic
from types import TracebackType
from typing import Any, Self

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.messages import caution
from springpot.trainer.recordings.recording import Zero, require_recording_name
from springpot.trainer.recordings.recording_file import (
    MIN_SAMPLES,
    RECORDING_SCHEMA,
    journal_of,
    read_journal,
    require_no_journal,
    write_recording,
)

_COMMIT_S = 0.5  # of wall clock between two commits: what a crash may take
_SCHEMA = """
PRAGMA locking_mode = EXCLUSIVE;
CREATE TABLE part (id INTEGER PRIMARY KEY, checksum INTEGER NOT NULL, content BLOB NOT NULL);
"""  # part 0: metadata as JSON; from 1 on rows of float64: position, force, further channels


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
        self.file, self.journal = file, journal_of(file)
        if file.exists():
            raise UsageError(f"{file}: exists and is not overwritten: give another name")
        require_no_journal(self.journal)
        self.full = False
        self.committed_rows = 0  # that survive whatever happens to this process
        self._width = 2 + len(channels)
        self._rows, self._parts, self._committed_s = 0, 0, monotonic()
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
            raise UsageError(f"{self.journal}: {error}: give another --out") from None
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
        self._rows += len(rows)
        if monotonic() - self._committed_s > _COMMIT_S:
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
        self._close()
        recording, _ = read_journal(self.journal)
        metadata = {**recording.details, **(details or {})}
        whole = replace(recording, details=metadata, session=session, start_s=start_s)
        try:
            write_recording(self.file, whole, overwrite=False)
        except FileExistsError:
            raise UsageError(
                f"{self.file}: another program wrote it meanwhile; this recording is kept in "
                f"{self.journal}: move one of them away"
            ) from None
        except OSError as error:
            raise self._failure(error) from None
        self.journal.unlink()

    def discard(self) -> None:
        """Remove the journal of a recording that never began."""
        self._close()
        self.journal.unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._store is None:
            return
        if self._rows < MIN_SAMPLES:
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
            self.committed_rows, self._committed_s = self._rows, monotonic()

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
