"""Progress of long work: a log record before each step, for a program that shows it."""

import logging
from collections.abc import Iterator, Sequence
from typing import TypeVar

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
