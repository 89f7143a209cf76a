"""Say what a CSV file lacks that a recording needs, and what to do."""

import json
import re
from itertools import pairwise
from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import (
    MAP_EXAMPLE,
    Column,
    ColumnMap,
    stated_rate_hz,
)
from springpot.trainer.recordings.formats.csv.csv_lines import Cells
from springpot.trainer.recordings.formats.csv.stress import STRESS_REMEDY, stress_and_strain
from springpot.trainer.recordings.formats.units import QUANTITIES, Quantity

MAX_NAMED = 12  # columns in a message
Candidates = dict[Quantity, list[int]]


def wanted_columns(columns: ColumnMap) -> tuple[Quantity, ...]:
    """Channels that are read from columns: all, or all but time where a rate is stated."""
    return tuple(q for q in QUANTITIES if q != "time" or stated_rate_hz(columns) is None)


def stated_header(column: Column | None) -> str:
    """Return the header that a map names; "" if it names a number or no column."""
    return column.header_or_number if column and isinstance(column.header_or_number, str) else ""


class MissingColumnsError(DataError):
    """No line of a file names all columns."""


class OtherTableError(MissingColumnsError):
    """A file has a header, with neither a position nor a force."""


def which_column(path: Path, index: int, row: Cells, found: Candidates) -> DataError:
    """Say which columns may be a channel, or that there are several tests, and what to pass."""
    sets = list(zip(*map(sorted, found.values()), strict=False))
    many = all(len(columns) == len(sets) > 1 for columns in found.values())
    if many and all(max(one) < min(other) for one, other in pairwise(sets)):
        maps = [",".join(f"{q}={i + 1}" for q, i in zip(found, one, strict=True)) for one in sets]
        return DataError(
            f"{path}, row {index + 1}: {len(sets)} tests side by side: import each by itself, into "
            f"a folder of its own: --map {', --map '.join(maps[:MAX_NAMED])}"
        )
    quantity, columns = next((q, its) for q, its in found.items() if len(its) > 1)
    names = ", ".join(f"{i + 1} {row[i]!r}" for i in columns[:MAX_NAMED])
    place = ", or name those of the place, --place X,Y" if quantity == "position" else ""
    return DataError(
        f"{path}, row {index + 1}: {quantity} may be column {names}: "
        f"choose by number, --map {quantity}={columns[0] + 1}:UNIT{place}"
    )


def missing_columns(
    path: Path, index: int, found: Candidates, row: Cells, columns: ColumnMap
) -> DataError:
    """Say which channels a file lacks, in the row with most of them, and what to pass."""
    wanted = [q for q in QUANTITIES if q in wanted_columns(columns) and q not in found]
    stated = {q: stated_header(columns.get(q)) for q in wanted}
    missing = [q + (f" ({stated[q]!r})" if stated[q] else "") for q in wanted]
    names = ", ".join(map(repr, row[:MAX_NAMED])) + (", ..." if row[MAX_NAMED:] else "")
    header = f" in row {index + 1}, which has {names}" if row else ""
    over = re.search("frequen|temperatur", names, re.I)
    if over and re.search("modul", names, re.I):
        what = "frequency" if over[0].casefold() == "frequen" else "temperature"
        return MissingColumnsError(
            f"{path}: moduli over {what}{header}: no recording; springpot learns from position "
            "and force over time: export the samples of the test"
        )
    if found.keys() == {"time"} and stress_and_strain(row):
        return MissingColumnsError(
            f"{path}: stress and strain in place of force and position{header}: --map: "
            f"{STRESS_REMEDY}"
        )
    if missing == ["time"] and row:
        return MissingColumnsError(
            f"{path}: found no column of time{header}: if its samples were taken evenly, pass "
            "--map time=RATEHz, RATE how many in a second; without it nobody knows how fast the "
            "object was pressed"
        )
    kind = OtherTableError if row and found.keys() <= {"time"} else MissingColumnsError
    return kind(
        f"{path}: found no column of {' or of '.join(missing)}{header}: pass --map {MAP_EXAMPLE}, "
        "where COL is a header or a column's number"
    )


def is_json(path: Path) -> bool:
    """Tell whether all of a file is JSON: a table may stand below a first line in braces."""
    try:
        return isinstance(json.loads(path.read_bytes()), dict | list)
    except (ValueError, RecursionError):
        return False
