"""The simulated objects by name, how one is changed and how it is pressed."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

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
    """Settings of recordings of a simulated object; a session does not use them.

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
    """Contents of a `sim://` URL: the object, changes to it, who presses it.

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
