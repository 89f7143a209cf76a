"""Units of files from outside: a unit's name, perhaps with a factor before it -> factor to SI."""

import math
import re
import shlex
import unicodedata
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any, Literal, get_args

from springpot.codegen.errors import DataError

Quantity = Literal["time", "position", "force"]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)
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
# Words, and masses that are written for their weight; casefolded.
_WORDS = {
    "msec": "ms", "millisecond": "ms", "milliseconds": "ms", "minutes": "min", "meter": "m",
    "meters": "m", "metre": "m", "metres": "m", "millimeter": "mm", "millimeters": "mm",
    "millimetre": "mm", "millimetres": "mm", "microns": "um", "inches": "in", "newton": "N",
    "newtons": "N", "millinewton": "mN", "kilonewton": "kN", "g": "gf", "gram": "gf",
    "grams": "gf", "kg": "kgf", "lb": "lbf", "lbs": "lbf", "oz": "ozf",
}  # fmt: skip
# Strain and stress, casefolded, in parts of 1 and in Pa: a way over the specimen's height, a force
# over its area.
_SPECIMEN_UNITS: dict[Quantity, dict[str, float]] = {
    "time": {},
    "position": {"%": 0.01, "mm/mm": 1.0, "m/m": 1.0, "in/in": 1.0, "-": 1.0},
    "force": {
        "pa": 1.0, "kpa": 1e3, "mpa": 1e6, "n/mm2": 1e6, "n/mm²": 1e6, "psi": 6894.757,
    },
}  # fmt: skip
# Height in m, area in m2: another specimen is one of no laboratory, and a factor was mistaken.
_MAX_SPECIMEN = {"position": (1.0, "m high"), "force": (0.15, "m2 wide")}
# "1e-3m" and "33 mm": what follows the number must not begin like one.
_WITH_FACTOR = re.compile(
    r"(?P<factor>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)?\s*(?P<unit>[^\d\s.+-].*)?"
)


@dataclass(frozen=True)
class Unit:
    """A channel's unit. origin: "map" if a person stated it, or its place in the file.

    column: how `--map` names the channel's column.
    """

    text: str
    to_si: float
    origin: str
    column: str

    def metadata(self) -> dict[str, Any]:
        fields = asdict(self)
        return {"unit": fields.pop("text"), "from": fields.pop("origin"), **fields}


def is_unit(text: str, quantity: Quantity) -> bool:
    """Return whether `text` is a unit of `quantity`, with no factor before it."""
    return _find_symbol(_normalise(text), quantity) is not None


def is_specimen_unit(text: str, quantity: Quantity) -> bool:
    """Return whether `text` is a unit of stress where force is wanted, of strain for position."""
    return text.casefold() in _SPECIMEN_UNITS[quantity]


def specimen_factor(text: str, quantity: Quantity) -> float:
    """Return what a unit of strain or stress is, in parts of 1 or in Pa."""
    return _SPECIMEN_UNITS[quantity][text.casefold()]


def specimen_remedy(columns: Mapping[Quantity, tuple[str, str]]) -> str:
    """Say which factors turn strain and stress, each a column and its unit, into mm and N."""
    parts, words = list[str](), list[str]()
    for quantity, (column, unit) in columns.items():
        size, of, to_unit, example, scale = (
            ("height", "mm", "mm", 12.5, 1.0)
            if quantity == "position"
            else ("area", "mm2", "N", 660.0, 1e-6)
        )
        factor = scale * specimen_factor(unit, quantity)
        times = f" times {factor:.6g}" if factor != 1.0 else ""
        parts.append(f"{quantity}={column}:FACTOR{to_unit}")
        words.append(
            f"the specimen's {size} in {of}{times} ({factor * example:.6g}{to_unit} of {example:g} "
            f"{of})"
        )
    return f"pass --map {shlex.quote(','.join(parts))}, FACTOR being {', and '.join(words)}"


def factor_to_si(text: str, quantity: Quantity, where: str) -> float:
    """Return the factor that turns a number in the unit `text` into s, m or N.

    A factor may stand before the unit: "33mm" is 33e-3, "-1mm" turns a sign round.
    where: begins the message, for instance "press.csv, column 'Load'".
    Raises DataError for an unknown or missing unit, or a factor of zero.
    """
    factor, unit = split_factor(text)
    known = ", ".join(_FACTORS[quantity])
    if not unit:
        raise DataError(f"{where}: no unit of {quantity}: give one of {known}")
    symbol = _find_symbol(unit, quantity)
    if symbol is None:
        remedy = "with a factor if needed (33mm)"
        if is_specimen_unit(unit, quantity):
            remedy = "with the specimen's height and area before the units of position and force"
        raise DataError(
            f"{where}: {unit!r} is not a unit of {quantity}: give one of {known}, {remedy}"
        )
    if factor == 0.0:
        raise DataError(f"{where}: a factor of 0 in {text!r} leaves nothing: give another")
    return factor * _FACTORS[quantity][symbol]


def format_map_option(quantity: str, column: str, unit: str) -> str:
    """The option that states a column and its unit, as it is typed."""
    return f"--map {shlex.quote(f'{quantity}={column}:{unit}')}"


def choose_unit(
    found: Mapping[str, str | None], quantity: Quantity, where: str, column: str
) -> Unit:
    """Return the unit that counts of those found: the map's, the header's or the row's below it.

    found: place -> text, the place "map" being a person's word. where: begins a message; column: as
    in `Unit`. Raises DataError as `factor_to_si` does, and if the map contradicts a unit of the
    file.
    """
    option = partial(format_map_option, quantity, column)
    origin, text = next(((o, t) for o, t in found.items() if t), ("", ""))
    if not text:
        raise DataError(
            f"{where}: no unit of {quantity}: pass {option('UNIT')}, UNIT one of "
            f"{', '.join(_FACTORS[quantity])}"
        )
    to_si = factor_to_si(text, quantity, where)
    factor, unit = split_factor(text)
    for source, file_unit in found.items() if origin == "map" else ():
        if source == "map" or not file_unit:
            continue
        if is_specimen_unit(file_unit, quantity):
            size, (limit, what) = (
                abs(to_si) / specimen_factor(file_unit, quantity),
                _MAX_SPECIMEN[quantity],
            )
            if size > limit and abs(factor) != 1.0:
                raise DataError(
                    f"{where}: its {source} says {file_unit}, the map {text}: then the specimen is "
                    f"{size:.3g} {what}: {specimen_remedy({quantity: (column, file_unit)})}"
                )
        if is_specimen_unit(file_unit, quantity) and abs(factor) == 1.0 and text[0] != "1":
            raise DataError(
                f"{where}: its {source} says {file_unit}, a unit of stress or strain: put the "
                f"specimen's height or area before the unit, {option('18' + unit)}, or 1 if it is "
                f"in {unit} after all, {option('1' + unit)}"
            )
        # A factor before the file's own unit corrects a wrong header.
        if is_unit(file_unit, quantity) and _find_symbol(unit, quantity) != _find_symbol(
            _normalise(file_unit), quantity
        ):
            ratio = to_si / factor_to_si(file_unit, quantity, where)
            if not math.isclose(abs(ratio), 1.0, rel_tol=1e-6):
                raise DataError(
                    f"{where}: its {source} says {file_unit}, the map says {text}: "
                    f"leave its unit out, or if {file_unit} is wrong pass "
                    f"{option(f'{ratio:.6g}{file_unit}')}"
                )
    return Unit(_find_symbol(_normalise(text), quantity) or text, to_si, origin, column)


def split_factor(text: str) -> tuple[float, str]:
    """Return the factor before a unit, 1 without one, and the unit."""
    match = _WITH_FACTOR.fullmatch(_normalise(text))
    if match is None:
        return 1.0, _normalise(text)
    return float(match["factor"] or 1.0), match["unit"] or ""


def _find_symbol(unit: str, quantity: Quantity) -> str | None:
    """The symbol of a unit in letters of either case, or of a word for it.

    Not of mn: mN and MN are too far apart to choose between.
    """
    known = _FACTORS[quantity]
    if unit in known:
        return unit
    folded = {symbol.casefold(): symbol for symbol in known if symbol != "mN"} | {
        word: symbol for word, symbol in _WORDS.items() if symbol in known
    }
    return folded.get(unit.casefold())


def _normalise(text: str) -> str:
    """Write both micro signs of Unicode as u."""
    return unicodedata.normalize("NFKC", text).strip().replace("μ", "u")
