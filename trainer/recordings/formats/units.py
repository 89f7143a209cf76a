"""Units of files from outside: a unit's name, perhaps with a factor before it -> factor to SI."""

import re
import unicodedata
from dataclasses import dataclass
from typing import Literal, get_args

from springpot.codegen.errors import DataError

Quantity = Literal["time", "position", "force"]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)

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
    return _plain(text) in _FACTORS[quantity]


def factor_to_si(text: str, quantity: Quantity, where: str) -> float:
    """Return what a number in the unit `text` is multiplied by to be in s, m or N.

    A factor may stand before the unit: "33mm" is 33e-3, "-1mm" turns a sign round.
    where: begins the message, for instance "press.csv, column 'Load'".
    Raises DataError for an unknown or missing unit, or a factor of zero.
    """
    match = _WITH_FACTOR.fullmatch(_plain(text))
    unit = (match["unit"] or "") if match else _plain(text)
    known = _FACTORS[quantity]
    if not unit:
        raise DataError(f"{where}: no unit of {quantity}: give one of {', '.join(known)}")
    if unit not in known:
        raise DataError(
            f"{where}: {unit!r} is not a unit of {quantity}{_near(unit, quantity)}: "
            f"give one of {', '.join(known)}, with a factor where needed (33mm)"
        )
    factor = float(match["factor"]) if match and match["factor"] else 1.0
    if factor == 0.0:
        raise DataError(f"{where}: a factor of 0 in {text!r} leaves nothing: give another")
    return factor * known[unit]


def _plain(text: str) -> str:
    """Write both micro signs of Unicode as u."""
    return unicodedata.normalize("NFKC", text).strip().replace("μ", "u")


def _near(unit: str, quantity: Quantity) -> str:
    """The unit that differs in case only; mN and MN are too far apart to choose between unasked."""
    near = [known for known in _FACTORS[quantity] if known.casefold() == unit.casefold()]
    return f" (did you mean {near[0]}?)" if near else ""
