"""What a harness says of the reader that it feeds: seeds, words of its format, and how to read."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.errors import SpringpotError

MAX_MESSAGE = 4000
# Of a file that is compressed or has checksums the fuzzer changes the parts: a harness packs them
# as the project does, so that what lies behind is reached.
_BETWEEN = b"\n--part--\n"


class PoorMessageError(Exception):
    """A refusal that is not one line, or that does not name the file."""


@dataclass(frozen=True)
class Reader:
    """A reader under test.

    seeds: small valid inputs, made by the project's own writers. words: of the format, for the
    fuzzer's dictionary. read: what a user's command does with such a file; it may raise errors that
    are shown to users and nothing else. own_process: where the project reads in a process of its
    own, `read` does not: what crashes or hangs is tried again as users would, by `as_users`.
    """

    seeds: Callable[[], Iterator[tuple[str, bytes]]]
    read: Callable[[bytes, Path], None]
    words: tuple[str, ...] = ()
    as_users: Callable[[bytes, Path], None] | None = None


def refused_in_one_line(read: Callable[[bytes, Path], None], content: bytes, folder: Path) -> None:
    """Read; let pass what is refused as users are told, and raise whatever else happens."""
    try:
        read(content, folder)
    except SpringpotError as error:
        message = str(error)
        if "\n" in message or not message.isprintable() or len(message) > MAX_MESSAGE:
            raise PoorMessageError(f"not one printable line: {message[:200]!r}") from None
        if str(folder) not in message:
            raise PoorMessageError(f"does not name the file: {message[:200]!r}") from None


def joined(parts: list[bytes]) -> bytes:
    """Return what the fuzzer sees of a file of these parts."""
    return _BETWEEN.join(parts)


def split(content: bytes) -> list[bytes]:
    """The parts of what the fuzzer made."""
    return content.split(_BETWEEN)
