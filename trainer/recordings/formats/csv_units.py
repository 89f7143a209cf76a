"""The units of a CSV file's columns: stated, in its header, or in the row below it."""

from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import Column, ColumnMap, map_option
from springpot.trainer.recordings.formats.labels import split_unit
from springpot.trainer.recordings.formats.units import COMMON_UNITS, Quantity, Unit, choose_unit


def column_units(
    path: Path,
    header: list[str],
    chosen: dict[Quantity, int],
    columns: ColumnMap,
    unit_row: dict[Quantity, str],
) -> dict[Quantity, Unit]:
    """The units of the map, which must not contradict the file's, or of the header or unit row.

    header: empty where there is none. chosen: columns from 0. unit_row: the units below the header.
    Raises DataError for a unit that is unknown or contradicts, and once for all that are missing.
    """
    labels = {q: header[index] if index < len(header) else "" for q, index in chosen.items()}
    named = {q: columns.get(q) or Column(labels[q] or index + 1) for q, index in chosen.items()}
    places = {
        q: {
            "map": named[q].unit,
            "header": split_unit(labels[q], q)[1],
            "row of units": unit_row.get(q),
        }
        for q in chosen
    }
    where = {
        q: f"column {index + 1}{f' {labels[q]!r}' if labels[q] else ''}"
        for q, index in chosen.items()
    }
    missing = [q for q in chosen if not any(places[q].values())]
    if missing:
        wanted = {**columns, **{q: Column(named[q].header_or_number, "UNIT") for q in missing}}
        raise DataError(
            f"{path}, {', '.join(where[q] for q in missing)}: no unit of {', of '.join(missing)}: "
            f"pass --map {map_option(wanted)}, with a unit such as "
            f"{', '.join(COMMON_UNITS[q] for q in missing)} for each UNIT"
        )
    return {
        q: choose_unit(places[q], q, f"{path}, {where[q]}", str(named[q].header_or_number))
        for q in chosen
    }
