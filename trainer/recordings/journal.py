"""Recording without losing anything: an append-only journal, and an HDF5 file only at the end.

HDF5 survives neither SIGKILL nor a full disk. A journal left behind by either is read like a
recording (`journal_reader.py`), short of what was not yet written: at most half a second.
"""

import fcntl
import json
import os
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from time import monotonic
from types import TracebackType
from typing import Any, Self

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.atomic_write import sync_folder
from springpot.codegen.errors import DeviceError, UsageError
from springpot.trainer.recordings.journal_blocks import (
    LAST_METADATA,
    METADATA,
    PAYLOAD_BYTES,
    SAMPLES,
    encode,
    max_rows,
)
from springpot.trainer.recordings.journal_reader import (
    MIN_SAMPLES,
    is_being_recorded,
    journal_of,
    read_journal,
)
from springpot.trainer.recordings.notices import caution
from springpot.trainer.recordings.recording import Zero
from springpot.trainer.recordings.recording_file import write_recording
from springpot.trainer.recordings.recording_name import require_recording_name

_MAX_S = 0.5  # of samples in a block, so that a slow recording loses no more than a fast one
_SYNC_S = 0.5  # of wall clock between two syncs: what a power cut may take


def refuse_where_journal(journal: Path) -> None:
    """Raise UsageError where a journal is there, saying whether somebody still records it."""
    try:
        recording_now = is_being_recorded(journal)
    except (FileNotFoundError, NotADirectoryError):
        return
    except OSError as error:
        raise UsageError(f"{journal}: {error.strerror}: choose another name or folder") from None
    if recording_now:
        raise UsageError(
            f"{journal}: another springpot is recording it now: choose another name or folder"
        )
    raise UsageError(
        f"{journal}: keeps a recording that was interrupted: choose another name or folder, or "
        "remove it; `springpot import` makes a recording of it"
    )


class JournalWriter:
    """Write one recording as it is made; `finish` turns it into an HDF5 file.

    Use it as a context manager: where it is left by an error, what was recorded is kept in the
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
        """Begin the recording `file`; name, dt_s, source, details, zero, place as in `Recording`.

        channels: names of what each row holds beside position and force.
        Raises DataError for a name that no recording can have, UsageError where it exists, is
        being recorded, or was interrupted before; DeviceError where it cannot be written.
        """
        require_recording_name(name)
        self.file, self.journal = file, journal_of(file)
        if file.exists():
            raise UsageError(f"{file}: exists and is not overwritten: give another name")
        self._descriptor = self._create()
        self._number = secrets.randbits(64)
        self._blocks = self._kept_rows = 0
        self._width = 2 + len(channels)
        self._rows = max(1, min(max_rows(self._width), int(_MAX_S / dt_s)))
        self._pending = np.empty((0, self._width))
        self._synced_s = monotonic()
        self.full = False
        self._closed = False
        metadata = {
            "schema": 1,
            "name": name,
            "dt_s": dt_s,
            "source": source,
            "zero": zero,
            "details": dict(details),
            "channels": list(channels),
            "block_s": self._rows * dt_s,
        }
        if place_m is not None:
            metadata["place_x_m"], metadata["place_y_m"] = place_m
        self._write_metadata(json.dumps(metadata).encode())
        sync_folder(file.parent)

    def append(
        self, position_m: Samples, force_n: Samples, channels: Samples | None = None
    ) -> None:
        """Take the next samples, each shape (n,). Raises DeviceError where the disk is full.

        channels: shape (n, k), a column for each channel beside them.
        """
        new = np.empty((len(position_m), self._width))
        new[:, 0], new[:, 1] = position_m, force_n
        if channels is not None:
            new[:, 2:] = channels
        self._pending = np.concatenate((self._pending, new))
        while len(self._pending) >= self._rows:
            self._write_samples(self._rows)
        if monotonic() - self._synced_s > _SYNC_S:
            self._sync()

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
        self._flush()
        try:
            recording = read_journal(self.journal).recording
            metadata = {**recording.details, **(details or {})}
            whole = replace(recording, details=metadata, session=session, start_s=start_s)
            write_recording(self.file, whole, overwrite=False)
        except FileExistsError:
            raise UsageError(
                f"{self.file}: another program wrote it meanwhile; this recording is kept in "
                f"{self.journal}: move one of them away"
            ) from None
        except OSError as error:
            raise self._failure(error) from None
        self.journal.unlink()
        self._close()

    def discard(self) -> None:
        """Remove the journal of a recording that never began."""
        self.journal.unlink(missing_ok=True)
        self._close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._closed:
            return
        try:
            if not self.full:
                self._flush()
        except DeviceError:
            pass  # the error that is under way is reported instead
        if self._kept_rows < MIN_SAMPLES:
            self.discard()
        else:
            self._close()
            caution(f"{self.journal}: what was recorded until now is kept there and can be read")

    def _create(self) -> int:
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND | os.O_CLOEXEC
        try:
            descriptor = os.open(self.journal, flags, 0o644)
        except FileExistsError:
            refuse_where_journal(self.journal)
            raise UsageError(f"{self.journal}: was there a moment ago: start again") from None
        except OSError as error:
            raise UsageError(f"{self.journal}: {error.strerror}: give another --out") from None
        fcntl.flock(descriptor, fcntl.LOCK_EX)  # readers see by it that somebody still records
        return descriptor

    def _write_metadata(self, text: bytes) -> None:
        parts = [text[k : k + PAYLOAD_BYTES] for k in range(0, len(text), PAYLOAD_BYTES)]
        for part in parts[:-1]:
            self._write(METADATA, part)
        self._write(LAST_METADATA, parts[-1])

    def _write_samples(self, count: int) -> None:
        self._write(SAMPLES, self._pending[:count].astype("<f8").tobytes())
        self._kept_rows += count
        self._pending = self._pending[count:]

    def _write(self, kind: int, payload: bytes) -> None:
        content = encode(self._number, self._blocks, kind, payload)
        try:
            while content:
                content = content[os.write(self._descriptor, content) :]
        except OSError as error:
            self.full = True
            raise self._failure(error) from None
        self._blocks += 1

    def _flush(self) -> None:
        if len(self._pending):
            self._write_samples(len(self._pending))
        self._sync()

    def _sync(self) -> None:
        try:
            os.fdatasync(self._descriptor)
        except OSError as error:
            raise self._failure(error) from None
        self._synced_s = monotonic()

    def _failure(self, error: OSError) -> DeviceError:
        return DeviceError(
            f"{self.file}: cannot go on writing ({error.strerror or error}), recording stopped: "
            f"make room; {self.journal.name} holds what was recorded and can be read"
        )

    def _close(self) -> None:
        os.close(self._descriptor)
        self._closed = True
