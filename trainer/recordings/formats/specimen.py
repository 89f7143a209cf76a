"""Stress and strain of a specimen with known sizes: the force on it, and its change of height."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isclose
from typing import Any

from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.formats.column_map import (
    Column,
    ColumnMap,
    guess_column,
    split_unit,
)
from springpot.trainer.recordings.formats.units import (
    OF_SPECIMEN,
    Quantity,
    factor_to_si,
    is_unit,
    parts_of,
)

_WORDS: dict[Quantity, str] = {
    "position": "strain|dehnung|stauchung|déformation",
    "force": "stress|spannung|contrainte",
}
_TRUE = "true|wahr"  # of the specimen's present size
_SIZE: Quantity = "position"
_MAX_SIZE = 1.0  # m2 or m: what is more is in mm2 or mm
_SI: dict[Quantity, str] = {"position": "m", "force": "N"}


@dataclass(frozen=True)
class Specimen:
    """Area under stress, m2, and height, m. Raises UsageError for a size that no specimen has.

    >>> Specimen(area_m2=491e-6, height_m=0.025).height_m
    0.025
    """

    area_m2: float
    height_m: float

    def __post_init__(self) -> None:
        if min(self.area_m2, self.height_m) <= 0.0:
            raise UsageError(
                f"--area {self.area_m2:g} m2, --height {self.height_m:g} m: give both above 0"
            )
        sizes = (("--area", self.area_m2, "m2", 1e-6), ("--height", self.height_m, "m", 1e-3))
        large = [
            f"{option} {size:g} is in {unit}, and no specimen's: {size:g} m{unit} are "
            f"{option} {to_si * size:g}"
            for option, size, unit, to_si in sizes
            if size >= _MAX_SIZE
        ]
        if large:
            raise UsageError("; ".join(large))

    def columns(self, row: Sequence[str], stated: ColumnMap) -> ColumnMap:
        """Columns of engineering stress and strain, and what a map states in their place.

        Nothing of them if a row has not both, and a time.
        """
        timed = "time" in stated or guess_column(row, "time")
        both = stress_and_strain(row) if timed else {}
        return {**{quantity: Column(row[index]) for quantity, index in both.items()}, **stated}

    def in_si(
        self, labels: Mapping[Quantity, str], below: Mapping[Quantity, str], stated: ColumnMap
    ) -> ColumnMap:
        """The map with each stress as a force, each strain as a way: `kPa` is `0.5N` of 5 cm2.

        labels, below: header of each channel, and the cell of a row of units. A strain without a
        unit is a ratio. Raises UsageError for another unit.
        """
        sizes: dict[Quantity, float] = {"position": self.height_m, "force": self.area_m2}
        found = dict(stated)
        for quantity, size in sizes.items():
            column, label = stated.get(quantity) or Column(labels[quantity]), labels[quantity]
            text = column.unit or split_unit(label, quantity)[1] or below.get(quantity, "")
            named = re.search(_WORDS[quantity], label, re.I)
            factor, unit = parts_of(text) if text else (1.0, "-" if quantity == "position" else "")
            to_si = OF_SPECIMEN[quantity].get(unit.casefold() or "1")
            if to_si is not None:
                _require_engineering(label)
                unit = f"{factor * to_si * size:.15g}{_SI[quantity]}"
                found[quantity] = Column(label or column.header_or_number, unit)
            elif named and not column.unit:
                raise UsageError(
                    f"--area, --height: column {label!r} has none of the units "
                    f"{', '.join(OF_SPECIMEN[quantity])}: say which, --map {quantity}={label}:UNIT"
                )
        return found

    def made_of(self, details: Mapping[str, Any]) -> bool:
        """Return whether a reader took a stress or strain, as a recording's details say."""
        units = details.get("units", {})
        sizes = {"position": self.height_m, "force": self.area_m2}
        return any(
            isclose(abs(parts_of(str(units.get(q, {}).get("unit", "")))[0]), by * sizes[q])
            for q in _WORDS
            for by in OF_SPECIMEN[q].values()
        )


def _require_engineering(label: str) -> None:
    """Raise UsageError for true stress or strain: the sizes are those before the test."""
    if re.search(_TRUE, label, re.I):
        raise UsageError(
            f"--area, --height: column {label!r} is of the specimen's present size, and these are "
            "its sizes before the test: export engineering stress and strain, or make them: strain "
            "e = exp(true) - 1, stress = true / (1 + e) in tension"
        )


def size_in_si(text: str, power: int) -> float:
    """Read a specimen's size as a person writes it, in m2 or m where it has no unit.

    power: 1 of a length, 2 of an area. Raises UsageError for anything else.

    >>> size_in_si("33mm", 1), size_in_si("2 cm2", 2)
    (0.033, 0.0002)
    """
    factor, unit = parts_of(text)
    length = unit.rstrip("^2²") if power == 2 else unit
    squared = power == 1 or length != unit or not unit
    if not re.match(r"\s*[+-]?\.?\d", text) or not squared or (unit and not is_unit(length, _SIZE)):
        example = "18mm2" if power == 2 else "33mm"
        raise UsageError(f"{text!r} is not a size of a specimen: give it with a unit, {example}")
    return factor * (factor_to_si(length, _SIZE, text) if unit else 1.0) ** power


def stress_and_strain(row: Sequence[str]) -> dict[Quantity, int]:
    """The one column of strain and the one of stress, from 0; empty where a header has not both."""
    found: dict[Quantity, int] = {}
    for quantity, words in _WORDS.items():
        named = [
            i
            for i, cell in enumerate(row)
            if re.search(words, cell, re.I) and not re.search(f"rate|{_TRUE}", cell, re.I)
        ]
        if len(named) == 1:
            found[quantity] = named[0]
    return found if len(found) == len(_WORDS) else {}


def require_no_stress(
    where: str, labels: Mapping[Quantity, str], below: Mapping[Quantity, str], stated: ColumnMap
) -> None:
    """Raise DataError for a map that takes a column of stress for a force, or strain for a way.

    A factor before the unit is the area or height, or 1: somebody has thought of it. labels, below:
    as of `Specimen.in_si`.
    """
    for quantity, words in _WORDS.items():
        column, label = stated.get(quantity), labels[quantity]
        if column is None or not column.unit or re.match(r"\+?[\d.]|-(?!1\D)", column.unit):
            continue
        unit = split_unit(label, quantity)[1] or below.get(quantity, "")
        named = re.search(words, label, re.I) and not is_unit(unit, quantity)
        if named or unit.casefold() in OF_SPECIMEN[quantity]:
            what = "strain" if quantity == "position" else "stress"
            raise DataError(
                f"{where}: column {label!r} is one of {what}, --map says {column.unit}: pass "
                "--area M2 and --height M, the specimen's, and no unit for it; if it is in "
                f"{column.unit} after all, {quantity}=COL:1{column.unit.lstrip('-1')}"
            )
