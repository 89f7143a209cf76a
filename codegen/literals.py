"""Numbers as C literals: the shortest text that reads back as the same bits."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

_WIDTH = 96


def literal(value: Any) -> str:
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


def array_text(name: str, c_type: str, values: NDArray[Any]) -> str:
    """`static const` definition of a 1-D or 2-D array, row by row."""
    if values.ndim == 2:
        rows, columns = values.shape
        head = f"static const {c_type} {name}[{rows} * {columns}] = {{"
    else:
        head = f"static const {c_type} {name}[{len(values)}] = {{"
    return "\n".join([head, *wrapped(map(literal, values.ravel())), "};"])


def wrapped(items: Iterable[str]) -> list[str]:
    """Lines of comma-separated items, each at most 100 columns."""
    lines: list[str] = []
    line = ""
    for item in items:
        if line and len(line) + len(item) + 2 > _WIDTH:
            lines.append(f"    {line},")
            line = item
        else:
            line = f"{line}, {item}" if line else item
    return [*lines, f"    {line}"]


def struct_text(name: str, c_type: str, config: Any) -> str:
    """`static const` definition of a config struct from its dataclass, member by member."""
    members = []
    for member, value in vars(config).items():
        if isinstance(value, np.ndarray):
            text = "{" + ", ".join(map(literal, value)) + "}"
        else:
            text = literal(value)
        members.append(f"    .{member} = {text},")
    return "\n".join([f"static const {c_type} {name} = {{", *members, "};"])
