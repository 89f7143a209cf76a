"""The page on scenes lists its keys as the code reads them: defaults, values, bounds."""

import dataclasses
import re
import typing
from collections.abc import Iterator
from types import NoneType
from typing import Any

import pytest
from annotated_types import Gt, Interval
from support.paths import ROOT

from springpot.codegen.scene import Scene

PAGE = ROOT / "docs" / "reference" / "scene.md"
UNITS = {"_hz": "Hz", "_npm": "N/m", "_nspm": "N s/m", "_kg": "kg", "_s": "s", "_n": "N",
         "_ms": "ms", "_mm": "mm", "_nm": "N m", "_per_a": "N m/A", "_bytes": "bytes", "_us": "µs",
         "_um": "um", "m_per_turn": "m", "_turns": "turns", "_samples": "ticks",
         "_mps": "m/s"}  # fmt: skip


def page_rows() -> dict[str, list[str]]:
    """Cells of each key's row: unit, default, what it may be, meaning."""
    found: dict[str, list[str]] = {}
    section = ""
    for line in PAGE.read_text().splitlines():
        if line.startswith("## "):
            named = re.search(r"`\[(\w+)\]`", line)
            section = f"{named[1]}." if named else ""
        if row := re.fullmatch(r"\| `(\w+)` \|(.*)\|", line):
            found[section + row[1]] = [cell.strip() for cell in row[2].split("|")]
    return found


def scene_keys() -> Iterator[tuple[str, Any, Any]]:
    """Name, type and default of every key; MISSING without one."""
    hints = typing.get_type_hints(Scene, include_extras=True)
    for field in dataclasses.fields(Scene):
        kind = hints[field.name]
        if dataclasses.is_dataclass(kind):
            inner = typing.get_type_hints(kind, include_extras=True)
            for key in dataclasses.fields(kind):
                yield f"{field.name}.{key.name}", inner[key.name], key.default
        else:
            yield field.name, kind, field.default


KEYS = {name: (kind, default) for name, kind, default in scene_keys()}


def parts(kind: Any) -> Iterator[Any]:
    """Members of a union, what Annotated says of them, and values of a Literal."""
    if typing.get_origin(kind) is typing.Annotated:
        yield from typing.get_args(kind)[1:]
    elif typing.get_origin(kind) is typing.Literal:
        yield from typing.get_args(kind)
    else:
        for member in typing.get_args(kind):
            yield from parts(member) if member is not NoneType else ()


def test_every_key_is_listed_and_none_else() -> None:
    assert set(page_rows()) == set(KEYS)
    assert len(KEYS) > 30


@pytest.mark.parametrize("name", KEYS)
def test_a_row_says_what_the_code_reads(name: str) -> None:
    kind, default = KEYS[name]
    unit, said, may_be, meaning = page_rows()[name]
    endings = [ending for ending in UNITS if name.endswith(ending)]
    assert unit == (UNITS[max(endings, key=len)] if endings else "")
    assert meaning
    if default is dataclasses.MISSING:
        assert said == "must be stated"
    elif default is None:
        assert said
        assert not said.startswith("`")
    else:
        text = f'"{default}"' if isinstance(default, str) else repr(default)
        assert said == f"`{text}`"
    for part in parts(kind):
        if isinstance(part, Interval):
            low = part.ge if part.ge is not None else part.gt
            numbers = [float(word) for word in re.findall(r"-?[\d.]+(?:e-?\d+)?", may_be)]
            assert numbers == [low, part.le]
            assert ("above" in may_be) == (part.gt is not None)
        elif isinstance(part, Gt):
            assert may_be == f"above {part.gt:g}"
        else:
            assert (f'`"{part}"`' if isinstance(part, str) else f"`{part}`") in may_be
