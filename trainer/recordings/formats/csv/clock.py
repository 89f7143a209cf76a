"""Stamps of a clock in a column of time, such as 10:12:00.020: seconds from the first one."""

import re
from collections.abc import Iterable

_STAMP = re.compile(
    r"(?:(?P<days>\d+) days?, )?"
    r"(?:(?P<date>\d{1,4}(?P<between>[-/.])\d{1,2}(?P=between)\d{1,4})(?:T|\s+))?"
    r"(?:(?P<h>\d{1,4}):(?P<min>\d\d):(?P<s>\d\d(?:[.,:](?P<digits>\d*))?)"
    r"|(?P<only_min>\d{1,4}):(?P<only_s>\d\d[.,](?P<more_digits>\d+)))"
    r"\s*(?P<half>[ap]\.?m\.?)?\s*(?:Z|[+-]\d\d:?\d\d)?",
    re.I,
)
_DAY_S = 86400.0


def is_clock(cell: str) -> bool:
    """Return whether a cell is a clock's stamp: h:min:s or min:s.digits, perhaps behind a date.

    >>> is_clock("2026-11-24T10:12:00.020Z"), is_clock("1 day, 0:00:01"), is_clock("10:12")
    (True, True, False)
    """
    return _STAMP.fullmatch(cell) is not None


def printed_exponent(cell: str) -> int:
    """Return the power of ten of the last printed digit of a stamp, s."""
    found = _STAMP.fullmatch(cell)
    return -len(found["digits"] or found["more_digits"] or "") if found else 0


def clock_s(cells: Iterable[str]) -> list[float]:
    """Seconds of each stamp after the first; each midnight that is passed adds a day.

    Only differences count, so no date's order of day and month has to be known: another date than
    that of the row before, or without dates a clock that falls by half a day, is the next day.
    Raises ValueError with the number of the first cell that is no stamp.

    >>> clock_s(["23:59:59.5", "00:00:00.5"])
    [0.0, 1.0]
    """
    seconds: list[float] = []
    days, date, before_s = 0, None, 0.0
    for number, cell in enumerate(cells):
        found = _STAMP.fullmatch(cell)
        if found is None:
            raise ValueError(number)
        now_s = _of_day_s(found)
        if number:
            dated = found["date"] is not None
            days += found["date"] != date if dated else now_s < before_s - _DAY_S / 2.0
        date, before_s = found["date"], now_s
        seconds.append(days * _DAY_S + now_s)
    return [stamp_s - seconds[0] for stamp_s in seconds]


def _of_day_s(found: re.Match[str]) -> float:
    if found["h"] is None:
        return 60.0 * int(found["only_min"]) + float(found["only_s"].replace(",", "."))
    hours = int(found["h"])
    if found["half"]:
        hours = hours % 12 + (12 if found["half"].casefold().startswith("p") else 0)
    hours += 24 * int(found["days"] or 0)
    return 3600.0 * hours + 60.0 * int(found["min"]) + float(re.sub("[,:]", ".", found["s"]))
