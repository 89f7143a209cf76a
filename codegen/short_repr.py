"""A repr of one line: fields that are not as by default, arrays by their shape."""

from dataclasses import MISSING, Field, fields
from typing import Any

MOST = 200  # characters
_MANY = 8  # entries that are not shown one by one


def short_repr(self: Any) -> str:
    """Show a dataclass; `__repr__ = short_repr` in its body.

    >>> short_repr(Scene(1, "pad", "pad.spm", guard=Guard(max_force_n=12.0)))
    "Scene(schema=1, name='pad', model='pad.spm', guard=Guard(max_force_n=12.0))"
    """
    shown = [
        f"{item.name}={_brief(getattr(self, item.name))}"
        for item in fields(self)
        if item.repr and not _is_default(item, getattr(self, item.name))
    ]
    text = f"{type(self).__name__}({', '.join(shown)})"
    return text if len(text) <= MOST else f"{text[: MOST - 5]} ...)"


def _brief(value: Any) -> str:
    if hasattr(value, "shape") and value.shape:  # commands that load no numpy have reprs too
        return f"<{' x '.join(map(str, value.shape))} {value.dtype}>"
    if isinstance(value, tuple | list | dict) and len(value) > _MANY:
        return f"<{len(value)} entries>"
    return repr(value)


def _is_default(item: Field[Any], value: Any) -> bool:
    if hasattr(value, "shape") and value.shape:
        return False
    if item.default_factory is not MISSING:
        return bool(item.default_factory() == value)
    return item.default is not MISSING and bool(item.default == value)
