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
        new = not file.exists()
        self._stream = file.open("a+b", buffering=0)
        try:
            fcntl.flock(self._stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self.lines, whole = parse_lines(file.read_bytes(), str(file))
            if whole < file.stat().st_size:
                report(f"{file}: its last line was cut by a crash and is dropped: that step comes "
                       "again")  # fmt: skip
                self._stream.truncate(whole)
                os.fsync(self._stream)
            if new:
                sync_folder(file.parent)
        except BlockingIOError:
            self._stream.close()
            raise UsageError(
                f"{file}: in use: this session already runs, in another window perhaps"
            ) from None
        except BaseException:
            self._stream.close()
            raise

    def write(self, step: str, **content: Any) -> None:
        """Add a line; returns when it is on the disk."""
        line = {"seq": len(self.lines), "step": step, **content}
        text = encoded(line)
        while text:
            text = text[self._stream.write(text) :]
        os.fsync(self._stream)
        self.lines.append(line)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._stream.close()


def read_lines(file: Path) -> list[Line]:
    """Read a session's lines but a last one that was cut. Raises DataError for other damage."""
    return parse_lines(file.read_bytes(), str(file))[0]


def encoded(line: Line) -> bytes:
    """Return a line as it is in the file."""
    text = json.dumps(line, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return f'{text[:-1]},"crc":"{crc32c(text.encode()):08x}"}}\n'.encode()


def parse_lines(content: bytes, where: str) -> tuple[list[Line], int]:
    """Return lines, and how many bytes they take. Raises DataError where one is not as written."""
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
    """Return the line, or None if it is damaged."""
    try:
        line = json.loads(text)
        crc = line.pop("crc")
        return line if encoded(line) == text and isinstance(crc, str) else None
    except (ValueError, KeyError, AttributeError, TypeError):
        return None
