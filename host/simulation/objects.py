"""The simulated objects by name, and what a URL `sim://OBJECT` says of one."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qsl, urlsplit

from springpot.codegen.errors import UsageError
from springpot.codegen.types import JsonObject

if TYPE_CHECKING:
    from springpot.codegen.coupling.linear_loop import HandName

OBJECTS = ("ecoflex-00-10", "ecoflex-00-30", "ecoflex-00-50", "dragon-skin-fx", "dragon-skin-10")
# Of other physics; runtime_c/sim names the sources.
FOREIGN_OBJECTS = ("bergstrom-boyce", "stiffening-tissue", "mullins", "poro-viscoelastic")
PLACED_OBJECTS = ("lump",)  # not the same everywhere: pressed at a place
ALL_OBJECTS = OBJECTS + FOREIGN_OBJECTS + PLACED_OBJECTS
HAND_NAMES: "tuple[HandName, ...]" = ("mid", "firm", "light")
VARIANTS = ("a", "b")
BENCH_RATE_HZ = 1000


@dataclass(frozen=True)
class PressSettings:
    """How a simulated object is recorded; in a session, where no object is pressed, without use.

    rest_s: the same object is pressed again after so long; None: every press meets a fresh one.
    rate_hz: of the samples that are kept. drift_npmin: of the load cell's zero.
    glitch: the first position of a recording reads 0, as of an encoder that is not ready yet.
    """

    rest_s: float | None = None
    rate_hz: int = BENCH_RATE_HZ
    drift_npmin: float = 0.0
    glitch: bool = False


@dataclass(frozen=True)
class SimulatedObject:
    """What a `sim://` URL says: the object, how it is changed, who presses it.

    variant: "a" quasi-linear, "b" relaxation depends on stress: of the five silicones alone.
    stiffer: factor on the force.
    x_m, y_m: where a lump is pressed.
    seed: of the sensors' noise. delay_samples: 1 where the motor force leaves one tick late.
    """

    name: str
    variant: str = "a"
    stiffer: float = 1.0
    hand: "HandName" = "mid"
    seed: int = 0
    delay_samples: int = 0
    presses: PressSettings = PressSettings()
    x_m: float = 0.0
    y_m: float = 0.0


def parse_url(url: str, default_seed: int = 0) -> SimulatedObject:
    """Read `sim://OBJECT?variant=b&stiffer=10&hand=mid&seed=1&delay=1`.

    Presses take `rest=5&rate=50&drift=0.1&glitch=1` beside it; a lump `x=0.005&y=0.01`, m.
    default_seed: where the URL has none.
    Raises UsageError naming what is unknown and listing what exists.
    """
    parts = urlsplit(url)
    if parts.netloc not in ALL_OBJECTS or parts.path not in ("", "/"):
        known = ", ".join(ALL_OBJECTS)
        raise UsageError(f"{url}: no object {parts.netloc + parts.path!r}: use one of {known}")
    found: JsonObject = {"seed": default_seed}
    for key, value in parse_qsl(parts.query, keep_blank_values=True):
        if key not in _SETTINGS:
            raise UsageError(
                f"{url}: no setting {key!r}: use variant, stiffer, hand, seed or delay; to "
                "record, rest, rate, drift or glitch too; of lump x and y"
            )
        name, read = _SETTINGS[key]
        found[name] = read(url, key, value)
    of_presses = found.keys() & set(PressSettings.__dataclass_fields__)
    presses = PressSettings(**{name: found.pop(name) for name in of_presses})
    simulated = SimulatedObject(parts.netloc, **found, presses=presses)
    if simulated.name not in PLACED_OBJECTS and (simulated.x_m or simulated.y_m):
        raise UsageError(f"{url}: {simulated.name} is the same everywhere: leave x and y out")
    if simulated.name not in OBJECTS and simulated.variant != "a":
        raise UsageError(
            f"{url}: variant={simulated.variant}: {simulated.name} has no variants, they are of "
            f"{', '.join(OBJECTS)}: leave variant out"
        )
    return simulated


def _one_of(url: str, key: str, value: str, *, known: Sequence[str]) -> str:
    if value not in known:
        raise UsageError(f"{url}: no {key} {value!r}: use one of {', '.join(known)}")
    return value


def _bit(url: str, key: str, value: str) -> int:
    return int(_one_of(url, key, value, known=("0", "1")))


def _number(url: str, key: str, value: str, *, limits: tuple[float, float], what: str) -> float:
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    least, most = limits
    if not least <= number <= most:
        raise UsageError(f"{url}: {key}={value}: give {what} between {least:g} and {most:g}")
    return number


def _rate_hz(url: str, _key: str, value: str) -> int:
    rate_hz = int(value) if value.isascii() and value.isdigit() else 0
    if not (0 < rate_hz <= BENCH_RATE_HZ and BENCH_RATE_HZ % rate_hz == 0):
        raise UsageError(
            f"{url}: rate={value}: the bench samples at {BENCH_RATE_HZ} Hz: give a whole part of "
            "that, such as 500, 200, 100 or 50"
        )
    return rate_hz


def _seed(url: str, _key: str, value: str) -> int:
    if not (value.isascii() and value.isdigit() and int(value) < 2**31):
        raise UsageError(f"{url}: seed={value}: give a whole number below 2147483648")
    return int(value)


# Keys of a URL: the field that each one sets, and how it is read.
_SETTINGS: dict[str, tuple[str, Callable[[str, str, str], Any]]] = {
    "variant": ("variant", partial(_one_of, known=VARIANTS)),
    "hand": ("hand", partial(_one_of, known=HAND_NAMES)),
    "stiffer": ("stiffer", partial(_number, limits=(0.01, 1000), what="a factor")),
    "seed": ("seed", _seed),
    "delay": ("delay_samples", _bit),
    "rest": ("rest_s", partial(_number, limits=(0, 3600), what="seconds")),
    "rate": ("rate_hz", _rate_hz),
    "drift": ("drift_npmin", partial(_number, limits=(-1, 1), what="N a minute")),
    "x": ("x_m", partial(_number, limits=(-1, 1), what="metres")),
    "y": ("y_m", partial(_number, limits=(-1, 1), what="metres")),
    "glitch": ("glitch", lambda *given: bool(_bit(*given))),
}
