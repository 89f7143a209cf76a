"""Stress and strain in a table: no force and no way, before a factor of the map makes them so."""

import re
from collections.abc import Mapping, Sequence

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import ColumnMap, split_unit
from springpot.trainer.recordings.formats.units import OF_SPECIMEN, Quantity, is_unit

STRESS_REMEDY = (
    "give the specimen's height and area before the unit, position=COL:33mm of a strain and 33 mm, "
    "force=COL:18N of MPa and 18 mm2"
)
_WORDS: dict[Quantity, str] = {
    "position": "strain|dehnung|stauchung|déformation",
    "force": "stress|spannung|contrainte",
}


def stress_and_strain(row: Sequence[str]) -> bool:
    """Tell whether a header has one column of strain and one of stress."""
    return all(
        len([c for c in row if re.search(w, c, re.I) and not re.search("rate|true|wahr", c, re.I)])
        == 1
        for w in _WORDS.values()
    )


def require_no_stress(
    where: str, labels: Mapping[Quantity, str], below: Mapping[Quantity, str], stated: ColumnMap
) -> None:
    """Raise DataError for a map that takes a column of stress for a force, or strain for a way.

    A factor before the unit is the area or height, or 1: somebody has thought of it. labels, below:
    header of each channel, and the cell of a row of units.
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
                f"{where}: column {label!r} is one of {what}, --map says {column.unit}: "
                f"{STRESS_REMEDY}; if it is in {column.unit} after all, "
                f"{quantity}=COL:1{column.unit.lstrip('-1')}"
            )
