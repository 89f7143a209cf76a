"""What columns are called: the words and units in a header, and which channel they suggest."""

import re
from collections.abc import Sequence

from springpot.trainer.recordings.formats.units import Quantity, is_unit

_LABELS: dict[Quantity, set[str]] = {
    "time": {"time", "t", "timestamp"},
    "position": {
        *("position", "pos", "displacement", "disp", "depth", "penetration", "indentation"),
        *("compression", "extension", "stroke", "x", "z"),
    },
    "force": {"force", "load", "f", "fz"},
}
# "Compression stress" and "Extension rate" are neither positions nor forces.
_NOT_A_LABEL = {"stress", "strain", "rate", "speed", "velocity", "setpoint", "command"}
_BRACKETED_UNIT = re.compile(r"(.*?)[\s_,/]*[(\[{]\s*([^()\[\]{}]+?)\s*[)\]}]")
_SEPARATED_UNIT = re.compile(r"(.+?)\s*[,/]\s*([^,/]+)")
_APPENDED_UNIT = re.compile(r"(.+)[\s_]([^\s_]+)")
_MAX_HEADER = 200
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")


def split_unit(header: str, quantity: Quantity) -> tuple[str, str | None]:
    """Split "Time (s)", "Load [N]", "Time, s" or "position_mm" into label and unit.

    A longer header than any channel's is a label as it is: the patterns take the square of its
    length.
    """
    if len(header) > _MAX_HEADER:
        return header, None
    for pattern in (_BRACKETED_UNIT, _SEPARATED_UNIT):
        if match := pattern.fullmatch(header):
            return match[1], match[2]
    match = _APPENDED_UNIT.fullmatch(header)
    if match and is_unit(match[2], quantity):
        return match[1], match[2]
    return header, None


def guess_column(row: Sequence[str], quantity: Quantity) -> list[int]:
    """Prefer a label that is one of the known words to one that only contains such a word."""
    labels = [_CAMEL.sub("_", split_unit(cell, quantity)[0]).casefold().strip() for cell in row]
    exact = [i for i, label in enumerate(labels) if label in _LABELS[quantity]]
    if exact:
        return exact
    words = [set(re.split(r"[^a-z]+", label)) for label in labels]
    return [i for i, w in enumerate(words) if w & _LABELS[quantity] and not w & _NOT_A_LABEL]
