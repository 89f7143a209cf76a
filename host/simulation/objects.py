"""The simulated objects by name, and what a URL `sim://OBJECT` says of one."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qsl, urlsplit

from springpot.codegen.errors import UsageError

if TYPE_CHECKING:
    from springpot.codegen.coupling.linear_loop import HandName

OBJECTS = ("ecoflex-00-10", "ecoflex-00-30", "ecoflex-00-50", "dragon-skin-fx", "dragon-skin-10")
# Of other physics; runtime_c/sim names the sources.
FOREIGN_OBJECTS = ("bergstrom-boyce", "stiffening-tissue", "mullins", "poro-viscoelastic")
ALL_OBJECTS = OBJECTS + FOREIGN_OBJECTS
HAND_NAMES: "tuple[HandName, ...]" = ("mid", "firm", "light")
VARIANTS = ("a", "b")


@dataclass(frozen=True)
class SimulatedObject:
    """What a `sim://` URL says: the object, how it is changed, who presses it.

    variant: "a" quasi-linear, "b" relaxation depends on stress: of the five silicones alone.
    stiffer: factor on the force.
    seed: of the sensors' noise. delay_samples: 1 where the motor force leaves one tick late.
    """

    name: str
    variant: str = "a"
    stiffer: float = 1.0
    hand: "HandName" = "mid"
    seed: int = 0
    delay_samples: int = 0


def parse_url(url: str, default_seed: int = 0) -> SimulatedObject:
    """Read `sim://OBJECT?variant=b&stiffer=10&hand=mid&seed=1&delay=1`.

    default_seed: where the URL has none.
    Raises UsageError naming what is unknown and listing what exists.
    """
    parts = urlsplit(url)
    if parts.netloc not in ALL_OBJECTS or parts.path not in ("", "/"):
        known = ", ".join(ALL_OBJECTS)
        raise UsageError(f"{url}: no object {parts.netloc + parts.path!r}: use one of {known}")
    settings: dict[str, Any] = {"seed": default_seed}
    for key, value in parse_qsl(parts.query, keep_blank_values=True):
        match key:
            case "variant":
                settings["variant"] = _one_of(url, key, value, VARIANTS)
            case "hand":
                settings["hand"] = _one_of(url, key, value, HAND_NAMES)
            case "stiffer":
                settings["stiffer"] = _stiffer(url, value)
            case "seed":
                settings["seed"] = _seed(url, value)
            case "delay":
                settings["delay_samples"] = int(_one_of(url, key, value, ("0", "1")))
            case _:
                raise UsageError(
                    f"{url}: no setting {key!r}: use variant, stiffer, hand, seed or delay"
                )
    simulated = SimulatedObject(name=parts.netloc, **settings)
    if simulated.name in FOREIGN_OBJECTS and simulated.variant != "a":
        raise UsageError(
            f"{url}: variant={simulated.variant}: {simulated.name} has no variants, they are of "
            f"{', '.join(OBJECTS)}: leave variant out"
        )
    return simulated


def _one_of(url: str, key: str, value: str, known: Sequence[str]) -> str:
    if value not in known:
        raise UsageError(f"{url}: no {key} {value!r}: use one of {', '.join(known)}")
    return value


def _stiffer(url: str, value: str) -> float:
    try:
        stiffer = float(value)
    except ValueError:
        stiffer = math.nan
    if not 0.01 <= stiffer <= 1000:
        raise UsageError(f"{url}: stiffer={value}: give a factor between 0.01 and 1000")
    return stiffer


def _seed(url: str, value: str) -> int:
    if not (value.isascii() and value.isdigit() and int(value) < 2**31):
        raise UsageError(f"{url}: seed={value}: give a whole number below 2147483648")
    return int(value)
