"""Numbers as C literals: the shortest text that reads back as the same bits."""

from collections.abc import Iterable, Mapping
from dataclasses import is_dataclass

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.types import Scalar

_WIDTH = 95  # of the items: the indent and the last comma make it 100 columns


def c_literal(value: Scalar) -> str:
    """C literal of a numpy or Python number; float32 ends in f. Raises ValueError if not finite."""
    if isinstance(value, np.float32 | np.float64 | float):
        if not np.isfinite(value):
            raise ValueError(f"{value} has no C literal")
        text = str(value)
        if "." not in text and "e" not in text:
            text += ".0"
        return text + "f" if isinstance(value, np.float32) else text
    if isinstance(value, np.uint32):
        return f"{int(value)}u"
    return str(int(value))


def array_text(name: str, c_type: str, values: Reals) -> str:
    """`static const` definition of a 1-D or 2-D array, row by row."""
    head = f"static const {c_type} {name}[{' * '.join(map(str, values.shape))}] = {{"
    return "\n".join([head, *wrap_items(map(c_literal, values.ravel())), "};"])


def wrap_items(items: Iterable[str]) -> list[str]:
    """Return lines of comma-separated items, each at most 100 columns."""
    lines: list[str] = []
    line = ""
    for item in items:
        if line and len(line) + len(item) + 2 > _WIDTH:
            lines.append(f"    {line},")
            line = item
        else:
            line = f"{line}, {item}" if line else item
    return [*lines, f"    {line}"]


def constant_text(name: str, value: Scalar) -> str:
    """`static const` definition of a number, or of a config struct from its dataclass.

    Member by member; the struct of GuardConfig is sp_guard_config.
    """
    if not is_dataclass(value):
        return f"static const sp_real {name} = {c_literal(value)};"
    c_type = f"sp_{type(value).__name__.removesuffix('Config').lower()}_config"
    members = {}
    for key, item in vars(value).items():
        array = isinstance(item, np.ndarray)
        members[key] = f"{{{', '.join(map(c_literal, item))}}}" if array else c_literal(item)
    return members_text(name, c_type, members)


def members_text(name: str, c_type: str, members: Mapping[str, str]) -> str:
    """`static const` definition of a struct from its members' C text, in the struct's order.

    Without designators: C++ has none before 2020.
    """
    width = min(max(map(len, members.values())) + 1, 40)  # one member may be a whole array
    lines = [f"    {f'{text},':<{width}} /* {member} */" for member, text in members.items()]
    return "\n".join([f"static const {c_type} {name} = {{", *lines, "};"])
