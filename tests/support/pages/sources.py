"""The project's Python files, by floor and room."""

from collections.abc import Iterator
from pathlib import Path

from support.paths import ROOT

FLOORS = ["runtime_c", "codegen", "trainer", "host"]


def sources(*floors: str) -> Iterator[tuple[Path, str, str]]:
    """Files of the floors that hold code, each with its floor and room."""
    for floor in floors:
        for file in sorted((ROOT / floor).rglob("*.py")):
            place = file.relative_to(ROOT / floor)
            if place.name != "__init__.py":
                yield file, floor, place.parts[0].removesuffix(".py")
