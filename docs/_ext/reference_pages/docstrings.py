"""Docstrings of the Python interface: written as plain text with `code`, read by Sphinx as reST."""

import re
from typing import Any

_CODE = re.compile(r"(?<![`\w])`([^`\n]+)`(?!`)")


def as_rst(_app: Any, _what: str, _name: str, _of: Any, _options: Any, lines: list[str]) -> None:
    """Sphinx's autodoc-process-docstring: `this` is code, other marks and examples themselves."""
    example = False
    for number, line in enumerate(lines):
        example = bool(line.strip()) and (example or line.lstrip().startswith(">>>"))
        lines[number] = line if example else _line(line)


def _line(line: str) -> str:
    parts = _CODE.split(line)
    text = [re.sub(r"([*|]|(?<=\w)_(?!\w))", r"\\\1", part) for part in parts[::2]]
    code = [f"``{part}``" for part in parts[1::2]]
    return "".join(a + b for a, b in zip(text, [*code, ""], strict=True))
