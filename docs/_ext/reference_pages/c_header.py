"""The C interface, from the comments and declarations of sp.h and sp_notes.h."""

import re
from typing import NamedTuple

from springpot.runtime_c.paths import INCLUDE

_BLOCK = re.compile(
    r"/\* springpot declarations begin \*/\n(.*?)/\* springpot declarations end", re.S
)
_PART = re.compile(r"/\*(?P<comment>.*?)\*/|(?P<declared>[^;/]+;)", re.S)
_VALUE = re.compile(r"(SP_\w+) = (-?\d+),? +/\* (.*?) \*/", re.S)


class Declared(NamedTuple):
    """Functions that share a comment."""

    functions: list[str]
    comment: str


def declarations() -> list[Declared]:
    """Every function of sp.h in its order."""
    found: list[Declared] = []
    for part in _PART.finditer(_declared_in("sp.h")):
        if part["comment"]:
            text = _plain(part["comment"])
            if not re.fullmatch(r"springpot (pictures|places) (begin|end)", text):
                found.append(Declared([], text))
        elif "(" in part["declared"]:
            found[-1].functions.append(_plain(part["declared"]).removesuffix(";"))
    return found


def notes() -> list[tuple[str, int, str]]:
    """Name, value and meaning of every note and error of sp_notes.h."""
    return [(name, int(value), _plain(text))
            for name, value, text in _VALUE.findall(_declared_in("sp_notes.h"))]  # fmt: skip


def c_functions() -> str:
    """Markdown: what the head of sp.h says, then a directive for each group of functions."""
    head = (INCLUDE / "sp.h").read_text().split("*/")[0].removeprefix("/*")
    title, *paragraphs = re.split(r"\n \*\n", head)
    lines = [_paragraph(text) for text in (title, *paragraphs)]
    for group in declarations():
        first, *others = group.functions
        comment = group.comment.replace("*", r"\*")
        lines += ["", "```{eval-rst}", f".. c:function:: {first}"]
        lines += [*(f"                {other}" for other in others), "", f"   {comment}", "```"]
    return "\n".join(lines)


def c_notes() -> str:
    """Markdown: a directive for each note and error."""
    lines = []
    for name, value, meaning in notes():
        lines += ["", f":::{{c:macro}} {name}", f"`{value}`: {meaning}", ":::"]
    return "\n".join(lines)


def _declared_in(file: str) -> str:
    found = _BLOCK.search((INCLUDE / file).read_text())
    assert found, f"{file}: no declarations between their two marks"
    return found[1]


def _plain(text: str) -> str:
    """One line; stars at line beginnings are the comment's."""
    return " ".join(re.sub(r"^ \*(?= )", "", text, flags=re.M).split())


def _paragraph(text: str) -> str:
    """A paragraph of the head of the file; what is indented is code."""
    lines = [line.removeprefix(" * ").rstrip() for line in text.splitlines()]
    if all(line.startswith("    ") for line in lines if line):
        return "\n".join(["", "```c", *(line[4:] for line in lines), "```"])
    return "\n".join(["", *lines])
