"""Lines for people: counts, progress, notices, and a repr of one line.

Notices stand beside a result: how it was understood; what was recovered, left out, assumed. The
command line prints them on standard error; in Python they are records of the logger NOTICES, which
shows cautions by default, and all after `logging.basicConfig(level=logging.INFO)`.
"""

import logging
from collections.abc import Iterator, Sequence
from dataclasses import MISSING, Field, fields
from typing import Any, TypeVar

from springpot.codegen.errors import in_python

NOTICES = "springpot.notices"
_MAX_REPR_CHARACTERS = 200  # characters of a repr
_MAX_SHOWN_ENTRIES = 8  # entries that are not shown one by one
_Item = TypeVar("_Item")
_LOG = logging.getLogger("springpot.progress")


def counted_noun(number: int, what: str) -> str:
    """Write a count and its noun.

    >>> number_of(1, "gap"), number_of(2, "gap")
    ('1 gap', '2 gaps')
    """
    return f"{number} {what}" + ("" if number == 1 else "s")


def log_progress(what: str, done: int, total: int) -> None:
    """Log that `done` of `total` steps are done; what: the next one."""
    _LOG.info(what, extra={"done": done, "total": total})


def with_progress(items: Sequence[_Item], what: str) -> Iterator[_Item]:
    """Go through `items`, and log before each how many are done."""
    for done, item in enumerate(items):
        log_progress(what, done, len(items))
        yield item


def notice(line: str) -> None:
    """Log one line that asks nothing of anybody."""
    logging.getLogger(NOTICES).info(in_python(line))


def caution(line: str) -> None:
    """Log one line that somebody should read."""
    logging.getLogger(NOTICES).warning(in_python(line))


def short_repr(self: Any) -> str:
    """Show a dataclass; `__repr__ = short_repr` in its body.

    >>> short_repr(Scene(1, "pad", "pad.spm", guard=Guard(max_force_n=12.0)))
    "Scene(schema=1, name='pad', model='pad.spm', guard=Guard(max_force_n=12.0))"
    """
    shown = [
        f"{item.name}={_shorten(getattr(self, item.name))}"
        for item in fields(self)
        if item.repr and not _is_default(item, getattr(self, item.name))
    ]
    text = f"{type(self).__name__}({', '.join(shown)})"
    return text if len(text) <= _MAX_REPR_CHARACTERS else f"{text[: _MAX_REPR_CHARACTERS - 5]} ...)"


def _shorten(value: Any) -> str:
    if hasattr(value, "shape") and value.shape:  # commands that load no numpy have reprs too
        return f"<{' x '.join(map(str, value.shape))} {value.dtype}>"
    if isinstance(value, tuple | list | dict) and len(value) > _MAX_SHOWN_ENTRIES:
        return f"<{len(value)} entries>"
    return repr(value)


def _is_default(item: Field[Any], value: Any) -> bool:
    if hasattr(value, "shape") and value.shape:
        return False
    if item.default_factory is not MISSING:
        return bool(item.default_factory() == value)
    return item.default is not MISSING and bool(item.default == value)
