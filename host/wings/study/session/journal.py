"""What happened in a session of a study, line by line: nothing that was written is ever lost.

One JSON object a line, with a number and a CRC-32C of the rest; it is on the disk before the next
step is shown. A crash can cut the last line; whatever else is damaged is refused.
"""

import fcntl
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

from google_crc32c import value as crc32c

from springpot import DataError, UsageError
from springpot.basics import sync_folder
from springpot.console import say

Line = dict[str, Any]


class StudyJournal:
    """The lines of one session, in order; `write` adds one. Held by one process at a time."""

    def __init__(self, file: Path, report: Callable[[str], None] = say) -> None:
        """Open or begin it. Raises UsageError while another process holds it, DataError if damaged.

        report: takes the line that says that a cut line was dropped.
        """
        self.file = file
        new = not file.exists()
        self._descriptor = os.open(file, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
        try:
            self._lock()
            content = file.read_bytes()
            self.lines, whole = parse_lines(content, str(file))
            if whole < len(content):
                report(f"{file}: its last line was cut by a crash and is dropped: that step comes "
                       "again")  # fmt: skip
                os.ftruncate(self._descriptor, whole)
                os.fsync(self._descriptor)
            if new:
                sync_folder(file.parent)
        except BaseException:
            os.close(self._descriptor)
            raise

    def write(self, step: str, **content: Any) -> None:
        """Add a line; returns when it is on the disk."""
        line = {"seq": len(self.lines), "step": step, **content}
        text = encoded(line)
        written = 0
        while written < len(text):
            written += os.write(self._descriptor, text[written:])
        os.fsync(self._descriptor)
        self.lines.append(line)

    def close(self) -> None:
        os.close(self._descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def _lock(self) -> None:
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise UsageError(
                f"{self.file}: in use: this session already runs, in another window perhaps"
            ) from None


def read_lines(file: Path) -> list[Line]:
    """Lines of a session, without a last one that was cut. Raises DataError for other damage."""
    return parse_lines(file.read_bytes(), str(file))[0]


def encoded(line: Line) -> bytes:
    """A line as it is in the file."""
    text = json.dumps(line, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return f'{text[:-1]},"crc":"{crc32c(text.encode()):08x}"}}\n'.encode()


def parse_lines(content: bytes, where: str) -> tuple[list[Line], int]:
    """Lines, and how many bytes they take. Raises DataError where one is not as written."""
    lines: list[Line] = []
    at = 0
    while at < len(content):
        end = content.find(b"\n", at) + 1
        if not end:
            break  # cut by a crash: it was never acknowledged
        line = _decoded(content[at:end])
        if line is None or line.get("seq") != len(lines):
            raise DataError(
                f"{where}: line {len(lines) + 1} is damaged: take the file from your backup"
            )
        lines.append(line)
        at = end
    return lines, at


def _decoded(text: bytes) -> Line | None:
    """The line, or None where it is damaged."""
    try:
        line = json.loads(text)
        crc = line.pop("crc")
        return line if encoded(line) == text and isinstance(crc, str) else None
    except (ValueError, KeyError, AttributeError, TypeError):
        return None
