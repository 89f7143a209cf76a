"""Single keys of a person at a terminal, without waiting; nothing where there is no terminal."""

import contextlib
import os
import select
import sys
from collections.abc import Iterator
from typing import TextIO


class Keys:
    """Keys pressed since the last look."""

    def __init__(self, terminal: TextIO | None) -> None:
        self._terminal = terminal

    def pressed(self) -> str:
        found = ""
        while self._terminal is not None and select.select([self._terminal], [], [], 0)[0]:
            try:
                keys = os.read(self._terminal.fileno(), 64).decode(errors="replace")
            except OSError:  # a terminal that was closed gives none
                keys = ""
            if not keys:
                break
            found += keys
        return found


@contextlib.contextmanager
def reading_keys() -> Iterator[Keys]:
    """Read keys one by one while this lasts."""
    try:
        import termios
        import tty
    except ModuleNotFoundError:  # Windows
        termios = None  # type: ignore[assignment]
    if termios is None or not sys.stdin.isatty():
        yield Keys(None)
        return
    before = termios.tcgetattr(sys.stdin)
    tty.setcbreak(sys.stdin)
    try:
        yield Keys(sys.stdin)
    finally:
        with contextlib.suppress(termios.error):  # the terminal was closed
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
