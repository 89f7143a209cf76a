"""Reading a journal that a crash left behind: what is whole, and a message of what is lost."""

import fcntl
import os
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.regular_file import require_regular
from springpot.trainer.recordings.journal_blocks import (
    BLOCK_BYTES,
    LAST_METADATA,
    SAMPLES,
    Block,
    decode,
)
from springpot.trainer.recordings.metadata import (
    RecordingMetadata,
    checked_metadata,
    metadata_of_json,
)
from springpot.trainer.recordings.recording import RECORDING_SUFFIX, Recording

JOURNAL_SUFFIX = ".journal"
MIN_SAMPLES = 2  # fewer are no recording
MAX_LOST_S = 1.0  # at the end; more, or a hole before it, is for `springpot import` to cut


@dataclass(frozen=True)
class Recovered:
    """Recording out of a journal. lost: one line for people about what is missing, or empty."""

    recording: Recording
    lost: str


@dataclass(frozen=True)
class _Journal:
    metadata: RecordingMetadata
    block_s: float  # of a full block of samples
    blocks: list[Block | None]  # of samples, None where damaged

    def rows(self, blocks: list[Block | None]) -> list[Samples]:
        """Samples of the whole blocks among these, each (n, 2 + channels)."""
        return [block.rows(2 + len(self.metadata.channels)) for block in blocks if block]


def journal_of(file: Path) -> Path:
    """Path of the journal of the recording `file`."""
    return file.with_name(file.name.removesuffix(RECORDING_SUFFIX) + JOURNAL_SUFFIX)


def is_being_recorded(journal: Path) -> bool:
    """Return whether a living process still writes this journal."""
    descriptor = os.open(journal, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


def read_journal(path: Path) -> Recovered:
    """Recover the recording of one journal.

    Raises DataError where it holds no samples, where more than the last second is damaged, or
    where damage lies between whole blocks.
    """
    journal = _read(path)
    blocks = journal.blocks
    damaged = [k for k, block in enumerate(blocks) if block is None]
    whole = len(blocks)
    while whole and blocks[whole - 1] is None:
        whole -= 1
    lost_s = (len(blocks) - whole) * journal.block_s
    if (damaged and damaged[0] < whole) or lost_s > MAX_LOST_S + 1e-9:
        begin_s = _seconds(journal, damaged[0])
        raise DataError(
            f"{path}: {len(damaged)} of {len(blocks)} blocks of samples are damaged, the first "
            f"{begin_s:.3f} s after the start: `springpot import {path.name} --out DIR` cuts out "
            "the whole parts"
        )
    recording = _recording(path, journal, blocks[:whole], "")
    lost = f", up to {lost_s:.3f} s at its end are lost" if damaged else ""
    return Recovered(recording, lost)


def read_parts(path: Path) -> tuple[list[Recording], str]:
    """Cut the whole parts out of a damaged journal, and say in one line what lies between them."""
    journal = _read(path)
    parts: list[list[Block | None]] = [[]]
    holes = []
    for k, block in enumerate(journal.blocks):
        if block is not None:
            parts[-1].append(block)
        elif parts[-1]:
            parts.append([])
        if block is None:
            holes.append(f"{_seconds(journal, k):.3f} s")
    parts = [part for part in parts if sum(map(len, journal.rows(part))) >= MIN_SAMPLES]
    if not parts:
        raise DataError(f"{path}: no whole block of samples: nothing can be recovered")
    recordings = [
        _recording(path, journal, part, f"-part{k}" if len(parts) > 1 else "")
        for k, part in enumerate(parts, 1)
    ]
    found = f"journal of a recording that was interrupted, {len(journal.blocks)} blocks"
    if holes:
        found += f", {len(holes)} damaged and left out (from {', '.join(holes[:5])}"
        found += f"{', ...' if len(holes) > 5 else ''}), cut there into {len(parts)} parts"
    return recordings, found


def _read(path: Path) -> _Journal:
    try:
        require_regular(path)
        content = path.read_bytes()
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}: give a file that can be read") from None
    raw = [decode(content[k : k + BLOCK_BYTES]) for k in range(0, len(content), BLOCK_BYTES)]
    first = raw[0] if raw else None
    blocks = [
        block if block and first and (block.journal, block.index) == (first.journal, k) else None
        for k, block in enumerate(raw)
    ]
    metadata = _metadata(path, blocks)
    begin = next(k for k, block in enumerate(blocks) if block and block.kind == LAST_METADATA) + 1
    samples = [b if b and b.kind == SAMPLES else None for b in blocks[begin:]]
    row_bytes = 8 * (2 + len(metadata.channels))
    samples = [b if b and len(b.payload) % row_bytes == 0 else None for b in samples]
    journal = _Journal(metadata, metadata.block_s or metadata.dt_s, samples)
    if sum(map(len, journal.rows(samples))) < MIN_SAMPLES:
        raise DataError(f"{path}: a recording that was interrupted before its first samples: "
                        "remove it")  # fmt: skip
    return journal


def _metadata(path: Path, blocks: list[Block | None]) -> RecordingMetadata:
    text = b""
    for block in blocks:
        if block is None or block.kind == SAMPLES:
            break
        text += block.payload
        if block.kind == LAST_METADATA:
            return checked_metadata(str(path), metadata_of_json(str(path), text))
    raise DataError(
        f"{path}: a recording that was interrupted at its very start, or whose first block is "
        "damaged: without its rate and name nothing can be read, remove it"
    )


def _seconds(journal: _Journal, block: int) -> float:
    """Time at which a block begins: exact unless blocks before it were cut short."""
    return block * journal.block_s


def _recording(path: Path, journal: _Journal, blocks: list[Block | None], suffix: str) -> Recording:
    rows = np.concatenate(journal.rows(blocks))
    metadata = replace(journal.metadata, name=journal.metadata.name + suffix)
    columns = [np.ascontiguousarray(column, dtype=np.float64) for column in rows.T]
    return metadata.recording(
        str(path),
        position_m=columns[0],
        force_n=columns[1],
        channels=dict(zip(metadata.channels, columns[2:], strict=True)),
    )
