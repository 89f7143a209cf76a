"""Every key of a scene file as tables: types, defaults and texts are those of codegen/scene.py."""

import ast
import dataclasses
import inspect
import re
import types
import typing
from collections.abc import Iterator
from typing import Any, NamedTuple

from annotated_types import Gt, Interval

from springpot.codegen.scene import Scene

# By the end of a key's name; the longest that fits counts.
_UNITS = {"_hz": "Hz", "_npm": "N/m", "_nspm": "N s/m", "_kg": "kg", "_s": "s", "_n": "N",
          "_ms": "ms", "_mm": "mm", "_nm": "N m", "_per_a": "N m/A", "_bytes": "bytes", "_us": "µs",
          "_um": "µm", "m_per_turn": "m", "_turns": "turns", "_samples": "ticks",
          "_mps": "m/s"}  # fmt: skip
_TEXT = re.compile(r"(.*?\.)(?: Default: (.*?)\.)?(?: May be: (.*?)\.)?")


class KeyRow(NamedTuple):
    """A key and the cells of its row; section: "" for the first keys of the file."""

    section: str
    name: str
    unit: str
    default: str
    may_be: str
    meaning: str


def key_rows() -> Iterator[KeyRow]:
    """Every key in the order of the code. Raises ValueError for one without a text."""
    yield from _rows("", Scene)
    hints = typing.get_type_hints(Scene)
    for section in dataclasses.fields(Scene):
        if dataclasses.is_dataclass(kind := hints[section.name]):
            assert isinstance(kind, type)
            yield from _rows(section.name, kind)


def scene_key_tables() -> str:
    """Markdown: one table a section, a target for each key."""
    lines: list[str] = []
    section = None
    for row in key_rows():
        if row.section != section:
            section = row.section
            title = f"## `[{section}]`" if section else "## Without a section"
            lines += ["", title, "", "| key | unit | default | may be | meaning |",
                      "| --- | --- | --- | --- | --- |"]  # fmt: skip
        name = f"{row.section}.{row.name}".lstrip(".")
        target = f"[`{row.name}`]{{#{name.replace('.', '-').replace('_', '-')}}}"
        cells = (row.unit, row.default, row.may_be, row.meaning)
        lines.append(f"| {target} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _rows(section: str, kind: type) -> Iterator[KeyRow]:
    texts = _texts(kind)
    hints = typing.get_type_hints(kind, include_extras=True)
    for key in dataclasses.fields(kind):
        if dataclasses.is_dataclass(hints[key.name]):
            continue
        found = _TEXT.fullmatch(texts.get(key.name, ""))
        if not found:
            raise ValueError(f"codegen/scene.py: {key.name}: write below the key what it means")
        meaning, default, may_be = found.groups()
        endings = [ending for ending in _UNITS if key.name.endswith(ending)]
        unit = _UNITS[max(endings, key=len)] if endings else ""
        stated = may_be or ", ".join(_bounds(hints[key.name])) or "any"
        yield KeyRow(section, key.name, unit, default or _default(key.default), stated, meaning)


def _texts(kind: type) -> dict[str, str]:
    """Name of each key of a class, and the text below it."""
    (body,) = ast.parse(inspect.getsource(kind)).body
    assert isinstance(body, ast.ClassDef)
    found = {}
    for key, text in zip(body.body, body.body[1:], strict=False):
        match key, text:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(words))),
            ):
                found[name] = " ".join(words.split())
    return found


def _default(value: Any) -> str:
    if value is dataclasses.MISSING:
        return "must be stated"
    if value is None:
        return "none"
    return f'`"{value}"`' if isinstance(value, str) else f"`{value!r}`"


def _bounds(kind: Any) -> Iterator[str]:
    """What a key may be, of its type: values, or a range."""
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Literal:
        yield from (_default(value) for value in inner)
    elif kind is bool:
        yield "`true`, `false`"
    elif origin is typing.Annotated:
        yield from (_range(part) for part in inner[1:])
    elif origin in (typing.Union, types.UnionType):
        for member in inner:
            yield from _bounds(member)


def _range(part: Any) -> str:
    match part:
        case Interval(ge=low, le=high) if low is not None:
            return f"{low:g} to {high:g}"
        case Interval(gt=low, le=high):
            return f"above {low:g}, to {high:g}"
        case Gt(gt=low):
            return f"above {low:g}"
    raise ValueError(f"{part}: no words for these bounds")
