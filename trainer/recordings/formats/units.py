"""Units of files from outside: a unit's name, perhaps with a factor before it -> factor to SI."""

import math
import re
import shlex
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

from springpot.codegen.errors import DataError

Quantity = Literal["time", "position", "force"]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)
FRAME_NAME = "column's name"  # origin of a unit that a table in memory states
CLOCK = "clock stamps"  # origin of the second where a column has 10:12:00: no number of a sample
COMMON_UNITS: dict[Quantity, str] = {"time": "s or ms", "position": "mm or m", "force": "N or mN"}

_GRAVITY_MPS2 = 9.80665  # standard gravity, exact by definition
_POUND_KG = 0.45359237  # international pound, exact by definition

_FACTORS: dict[Quantity, dict[str, float]] = {
    "time": {
        "s": 1.0, "sec": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9,
        "min": 60.0, "h": 3600.0,
    },
    "position": {
        "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "micron": 1e-6, "nm": 1e-9,
        "in": 25.4e-3, "inch": 25.4e-3,
    },
    "force": {
        "N": 1.0, "kN": 1e3, "mN": 1e-3, "uN": 1e-6, "gf": 1e-3 * _GRAVITY_MPS2,
        "kgf": _GRAVITY_MPS2, "lbf": _POUND_KG * _GRAVITY_MPS2,
        "ozf": _POUND_KG / 16.0 * _GRAVITY_MPS2,
    },
}  # fmt: skip
# Of a specimen, each a force over its area or a way over its height; casefolded.
OF_SPECIMEN: dict[Quantity, set[str]] = {
    "time": set(),
    "position": {"%", "mm/mm", "m/m", "in/in", "1", "-"},
    "force": {"pa", "kpa", "mpa", "n/mm2", "n/mm²", "psi"},
}
_WORDS: dict[Quantity, dict[str, str]] = {
    "time": {"msec": "ms", "millisecond": "ms", "milliseconds": "ms", "minutes": "min"},
    "position": {
        **dict.fromkeys(("meter", "meters", "metre", "metres"), "m"),
        **dict.fromkeys(("millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
        "microns": "um", "inches": "in",
    },
    "force": {"newton": "N", "newtons": "N", "millinewton": "mN", "kilonewton": "kN"},
}  # fmt: skip
# Letters of either case are taken, but for mN and MN, which are too far apart to choose between.
_EITHER_CASE: dict[Quantity, dict[str, str]] = {
    quantity: {u.casefold(): u for u in units if u != "mN"} | _WORDS[quantity]
    for quantity, units in _FACTORS.items()
}
_MEANT = {"mn": "mN", "g": "gf", "kg": "kgf", "lb": "lbf", "lbs": "lbf", "oz": "ozf"}
# What a machine writes above a column of force: the weight of such a mass.
_WEIGHTS = {**_MEANT, "gram": "gf", "grams": "gf"}
# "1e-3m" and "33 mm": what follows the number must not begin like one.
_WITH_FACTOR = re.compile(
    r"(?P<factor>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)?\s*(?P<unit>[^\d\s.+-].*)?"
)


@dataclass(frozen=True)
class Unit:
    """A channel's unit as it was found. origin: "map" where a person stated it, or its place.

    column: how `--map` names the channel's column.
    """

    text: str
    to_si: float
    origin: str
    column: str

    def metadata(self) -> dict[str, str | float]:
        return {
            "unit": self.text, "to_si": self.to_si, "from": self.origin, "column": self.column,
        }  # fmt: skip


def is_unit(text: str, quantity: Quantity) -> bool:
    """Return whether `text` is a unit of `quantity`, with no factor before it."""
    return _known(_plain(text), quantity) is not None


def is_weight(text: str, quantity: Quantity) -> bool:
    """Return whether a header's `text` is a mass that is written for its weight, such as g."""
    return quantity == "force" and text.casefold() in _WEIGHTS and text.casefold() != "mn"


def units_near(to_si: float, quantity: Quantity) -> str:
    """Return the units that are within a fifth of a size, as "kgf"; "" where none is.

    >>> units_near(9.5, "force"), units_near(2.0, "force")
    ('kgf', '')
    """
    sizes = _FACTORS[quantity].items()
    return " or ".join(unit for unit, size in sizes if abs(math.log(size / to_si)) < math.log(1.2))


def factor_to_si(text: str, quantity: Quantity, where: str) -> float:
    """Return what a number in the unit `text` is multiplied by to be in s, m or N.

    A factor may stand before the unit: "33mm" is 33e-3, "-1mm" turns a sign round.
    where: begins the message, for instance "press.csv, column 'Load'".
    Raises DataError for an unknown or missing unit, or a factor of zero.
    """
    factor, unit = parts_of(text)
    known = _FACTORS[quantity]
    if not unit:
        raise DataError(f"{where}: no unit of {quantity}: give one of {', '.join(known)}")
    symbol = _known(unit, quantity)
    if symbol is None:
        raise DataError(
            f"{where}: {unit!r} is not a unit of {quantity}{_near(unit, quantity)}"
            f" give one of {', '.join(known)}, with a factor where needed (33mm)"
        )
    if factor == 0.0:
        raise DataError(f"{where}: a factor of 0 in {text!r} leaves nothing: give another")
    return factor * known[symbol]


def choose_unit(
    found: Mapping[str, str | None],
    quantity: Quantity,
    where: str,
    column: str,
    in_python: bool = False,
) -> Unit:
    """Return the first unit of `found`: place -> text, the place "map" being what a person stated.

    where: begins a message, column: as in `Unit`, in_python: as in `RawChannels`.
    Raises DataError as `factor_to_si` does, and where the map contradicts a unit of the file.
    """
    origin, text = next(((o, t) for o, t in found.items() if t), ("", ""))
    if not text:
        raise DataError(
            f"{where}: no unit of {quantity}: pass {_map(quantity, column, 'UNIT', in_python)}, "
            f"UNIT one of {', '.join(_FACTORS[quantity])}"
        )
    if origin == "map":
        _check_agreement(found, quantity, where, column, in_python)
    elif is_weight(text, quantity):
        text = _WEIGHTS[text.casefold()]
    to_si = factor_to_si(text, quantity, where)
    unit = _plain(text)
    symbol = _known(unit, quantity)
    return Unit(text if symbol in (None, unit) else str(symbol), to_si, origin, column)


def _check_agreement(
    found: Mapping[str, str | None], quantity: Quantity, where: str, column: str, in_python: bool
) -> None:
    """Refuse a unit of the map that is not the file's, unless the two are of one size.

    A factor before the file's own unit is no contradiction: it is how to correct a wrong header.
    """
    stated = found["map"] or ""
    place, text = next(
        ((o, t) for o, t in found.items() if o != "map" and t and is_unit(t, quantity)), ("", "")
    )
    if not text or _known(parts_of(stated)[1], quantity) == _known(_plain(text), quantity):
        return
    ratio = factor_to_si(stated, quantity, where) / factor_to_si(text, quantity, where)
    if not math.isclose(abs(ratio), 1.0, rel_tol=1e-6):
        by, stated_in = (f"{quantity}=", "name") if in_python else ("--map", "file")
        raise DataError(
            f"{where}: its {place} says {text}, {by} says {stated}: leave the unit out of {by} "
            f"to take {text}, or where the {stated_in} is wrong pass "
            f"{_map(quantity, column, f'{ratio:.6g}{text}', in_python)}"
        )


def _map(quantity: Quantity, column: str, unit: str, in_python: bool) -> str:
    stated = f"{column}:{unit}"
    if in_python:
        return f"{quantity}={stated!r}"
    return f"--map {shlex.quote(f'{quantity}={stated}')}"


def parts_of(text: str) -> tuple[float, str]:
    """The factor before a unit, 1 where there is none, and the unit."""
    match = _WITH_FACTOR.fullmatch(_plain(text))
    if match is None:
        return 1.0, _plain(text)
    return float(match["factor"] or 1.0), match["unit"] or ""


def _known(unit: str, quantity: Quantity) -> str | None:
    """The symbol of a unit that may be written in letters of the other case, or as a word."""
    if unit in _FACTORS[quantity]:
        return unit
    return _EITHER_CASE[quantity].get(unit.casefold())


def _plain(text: str) -> str:
    """Write both micro signs of Unicode as u."""
    return unicodedata.normalize("NFKC", text).strip().replace("μ", "u")


def _near(unit: str, quantity: Quantity) -> str:
    """The unit that may be meant, but is not chosen unasked."""
    if unit.casefold() in OF_SPECIMEN[quantity]:
        what, size = ("stress", "area") if quantity == "force" else ("strain", "height")
        return f", it is one of {what}: put the specimen's {size} before a unit of {quantity}:"
    meant = _MEANT.get(unit.casefold()) if quantity == "force" else None
    return f" (did you mean {meant}?):" if meant else ":"
