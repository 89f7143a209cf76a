"""Words of messages, and progress of long work."""

import logging
from collections.abc import Iterator, Sequence
from typing import TypeVar


def number_of(number: int, what: str) -> str:
    """Write how many there are of what.

    >>> number_of(1, "gap"), number_of(2, "gap")
    ('1 gap', '2 gaps')
    """
    return f"{number} {what}" + ("" if number == 1 else "s")


_Item = TypeVar("_Item")
_LOG = logging.getLogger("springpot.progress")


def at_step(what: str, done: int, total: int) -> None:
    """Log that `done` of `total` steps are done; what: the next one."""
    _LOG.info(what, extra={"done": done, "total": total})


def counted(items: Sequence[_Item], what: str) -> Iterator[_Item]:
    """Go through `items`, and log before each how many are done."""
    for done, item in enumerate(items):
        at_step(what, done, len(items))
        yield item
