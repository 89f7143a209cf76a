"""Stress and strain of a specimen with known sizes: the force on it, and its change of height."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from springpot.codegen.errors import UsageError
from springpot.trainer.recordings.formats.column_map import (
    Column,
    ColumnMap,
    guess_column,
    split_unit,
)
from springpot.trainer.recordings.formats.units import Quantity

_WORDS: dict[Quantity, str] = {
    "position": "strain|dehnung|stauchung|déformation",
    "force": "stress|spannung|contrainte",
}
_FACTORS: dict[Quantity, dict[str, float]] = {
    "position": {"%": 0.01, "mm/mm": 1.0, "m/m": 1.0, "in/in": 1.0, "1": 1.0, "-": 1.0},
    "force": {"pa": 1.0, "kpa": 1e3, "mpa": 1e6, "n/mm2": 1e6, "n/mm²": 1e6, "psi": 6894.757},
}
_SI: dict[Quantity, str] = {"position": "m", "force": "N"}


@dataclass(frozen=True)
class Specimen:
    """Area under stress, m2, and height, m. Raises UsageError for a size that is not above 0."""

    area_m2: float
    height_m: float

    def __post_init__(self) -> None:
        if min(self.area_m2, self.height_m) <= 0.0:
            raise UsageError(
                f"--area {self.area_m2:g} m2, --height {self.height_m:g} m: give both above 0"
            )

    def columns(self, row: Sequence[str], units: Sequence[str]) -> ColumnMap:
        """Map columns of engineering stress and strain; nothing if a row has not both, and time.

        units: the cells below the row, which may hold the units.
        """
        sizes: dict[Quantity, float] = {"position": self.height_m, "force": self.area_m2}
        found: dict[Quantity, Column] = {}
        both = stress_and_strain(row) if guess_column(row, "time") else {}
        for quantity, index in both.items():
            below = units[index].strip("()[] ") if index < len(units) else ""
            unit = split_unit(row[index], quantity)[1] or below
            factor = _FACTORS[quantity].get(unit.casefold())
            if factor is None:
                raise UsageError(
                    f"--area, --height: column {row[index]!r} has none of the units "
                    f"{', '.join(_FACTORS[quantity])}: map it, --map {quantity}=COL:FACTOR"
                    f"{_SI[quantity]}"
                )
            found[quantity] = Column(row[index], f"{factor * sizes[quantity]!r}{_SI[quantity]}")
        return found

    def made_of(self, details: Mapping[str, Any]) -> bool:
        """Return whether a reader took stress and strain, as a recording's details say."""
        units = details.get("units", {})
        named = {q: str(units.get(q, {}).get("column", "")) for q in _WORDS}
        return all(re.search(words, named[q], re.I) for q, words in _WORDS.items())


def stress_and_strain(row: Sequence[str]) -> dict[Quantity, int]:
    """The one column of strain and the one of stress, from 0; empty where a header has not both."""
    found: dict[Quantity, int] = {}
    for quantity, words in _WORDS.items():
        named = [
            i
            for i, cell in enumerate(row)
            if re.search(words, cell, re.I) and not re.search("rate|true|wahr", cell, re.I)
        ]
        if len(named) == 1:
            found[quantity] = named[0]
    return found if len(found) == len(_WORDS) else {}
