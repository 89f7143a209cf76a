"""What a message to a user must have: one printable line, with the parts that the user acts on."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest


def require_line(message: object, *parts: object) -> None:
    """Assert that a message is one printable line that has the parts."""
    line = str(message)
    assert line.isprintable(), line
    for part in map(str, parts):
        assert part in line, f"no {part!r} in {line!r}"


@contextmanager
def refusing(error: type[Exception], *parts: object) -> Iterator[None]:
    """Assert that what follows raises that error, its message a line with the parts."""
    with pytest.raises(error) as caught:
        yield
    require_line(caught.value, *parts)
