"""Units of a CSV file that stand in no header: in the row below it, or in lines above it."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import ColumnMap, split_unit
from springpot.trainer.recordings.formats.csv.csv_lines import Cells, cells, is_value
from springpot.trainer.recordings.formats.units import (
    OF_SPECIMEN,
    Quantity,
    factor_to_si,
    is_unit,
)


def unit_row(row: Cells, chosen: dict[Quantity, int]) -> dict[Quantity, str]:
    """Return the units in the row below the header, or nothing where it is not a row of units."""
    if len(row) <= max(chosen.values()):
        return {}
    units = {quantity: row[index].strip("()[]{} ") for quantity, index in chosen.items()}
    if any(map(is_value, units.values())):
        return {}
    known = (is_unit(unit, q) or unit.casefold() in OF_SPECIMEN[q] for q, unit in units.items())
    return units if any(known) else {}


def labview_units(
    above: Sequence[str], delimiter: str, chosen: dict[Quantity, int]
) -> dict[Quantity, str]:
    """Units that a LabVIEW measurement file states in lines above its header: times are in s."""
    rows = [cells(line, delimiter) for line in above]
    stated = {row[0]: row for row in rows if row}
    if not any(key.startswith("***End_of_Header***") for key in stated):
        return {}
    labels = stated.get("Y_Unit_Label", [])
    timed = "Time" in stated.get("X_Dimension", ["Time"])
    second = "s" if timed else ""
    return {q: second if q == "time" else "".join(labels[i:][:1]) for q, i in chosen.items()}


def clock_units(
    header: Cells, columns: ColumnMap, units: dict[Quantity, str], index: int
) -> tuple[Cells, ColumnMap, dict[Quantity, str]]:
    """Header, map and units with stamps of a clock in s: what they say of it, hh:mm:ss, is form."""
    if index < len(header):
        header = [*header[:index], split_unit(header[index], "time")[0], *header[index + 1 :]]
    if "time" in columns:
        columns = {**columns, "time": replace(columns["time"], unit=None)}
    return header, columns, {**units, "time": "s"}


def pair_columns(
    path: Path, header: Cells, unit_row: Cells, pair: str, quantity: Quantity
) -> tuple[tuple[int, float], ...]:
    """Columns named pair_x and pair_y, with their factors to m or N; none without.

    Raises DataError for one of them alone, and for a name that two columns have.
    """
    labels = [split_unit(cell, quantity) for cell in header]
    found = []
    for name in (f"{pair}_x", f"{pair}_y"):
        same = [index for index, (label, _) in enumerate(labels) if label.casefold() == name]
        if len(same) > 1:
            raise DataError(f"{path}: {len(same)} columns are named {name}: leave one of them")
        for index in same:
            below = unit_row[index].strip("()[]{} ") if index < len(unit_row) else ""
            where = f"{path}, column {header[index]!r}"
            found.append((index, factor_to_si(labels[index][1] or below, quantity, where)))
    if len(found) == 1:
        raise DataError(f"{path}: {pair}_x and {pair}_y belong together: add the other column")
    return tuple(found)
