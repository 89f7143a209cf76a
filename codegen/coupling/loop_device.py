"""The device in the loop: what a hand moves, what brakes it, how late its force acts."""

import math
from dataclasses import dataclass, replace

from springpot.codegen.scene import Device
from springpot.codegen.types import JsonObject

DEVICE_MASS_KG = 0.3
DEVICE_DAMPING_NSPM = 4.0
RESOLUTION_UM = 10.0
_NOISE_PER_STEP = 0.3  # of the encoder
_ROUNDING = 1e-6  # of a tick: 3 ms are three ticks of 1 ms, however they are rounded


@dataclass(frozen=True)
class LoopDevice:
    """A device without its hand; by default the one that is assumed.

    resolution_um, noise_um: the encoder's step and noise. delay_samples: whole ticks from a sample
    to when its force acts. stated: which of mass and friction the scene states.
    """

    mass_kg: float = DEVICE_MASS_KG
    viscous_nspm: float = DEVICE_DAMPING_NSPM
    coulomb_n: float = 0.0
    resolution_um: float = RESOLUTION_UM
    noise_um: float = _NOISE_PER_STEP * RESOLUTION_UM
    delay_samples: int = 0
    stated: tuple[str, ...] = ()

    @property
    def measured(self) -> bool:
        """True if the scene states what a linear loop needs: mass and viscous friction."""
        return {"mass_kg", "viscous_nspm"} <= set(self.stated)

    def with_delay(self, ticks: int) -> "LoopDevice":
        """Return the same with so many more ticks of delay."""
        return replace(self, delay_samples=self.delay_samples + ticks)

    def as_dict(self, dt_s: float) -> JsonObject:
        """Return keys of `stability --json`; delay_s: of the whole ticks that are used."""
        return {
            "mass_kg": self.mass_kg,
            "viscous_nspm": self.viscous_nspm,
            "coulomb_n": self.coulomb_n,
            "resolution_um": self.resolution_um,
            "position_noise_um": self.noise_um,
            "delay_s": self.delay_samples * dt_s,
            "delay_samples": self.delay_samples,
            "measured": self.measured,
        }

    def words(self, dt_s: float) -> str:
        """Describe the device that a check assumed, in a line."""
        figures = [
            f"{value:g} {unit}" + (" (assumed)" if self.stated and name not in self.stated else "")
            for name, value, unit in (
                ("mass_kg", self.mass_kg, "kg"),
                ("viscous_nspm", self.viscous_nspm, "N s/m"),
            )
        ]
        if self.coulomb_n > 0.0:
            figures.append(f"{self.coulomb_n:g} N Coulomb friction")
        if self.delay_samples > 0:
            figures.append(f"{1e3 * self.delay_samples * dt_s:g} ms late")
        named = ", ".join(figures)
        if self.stated:
            return f"the scene's device: {named}"
        return f"assumed device: {named} (none is stated in [device])"


ASSUMED_DEVICE = LoopDevice()


def build_loop_device(device: Device, dt_s: float) -> LoopDevice:
    """Return the device that a scene states, with assumed figures where the scene is silent."""
    stated = {name: getattr(device, name) for name in ("mass_kg", "viscous_nspm", "coulomb_n")
              if getattr(device, name) is not None}  # fmt: skip
    late = device.delay_samples
    if device.delay_s is not None:
        late = math.ceil(device.delay_s / dt_s - _ROUNDING)
    noise_um = device.position_noise_um
    noise_um = _NOISE_PER_STEP * device.resolution_um if noise_um is None else noise_um
    return LoopDevice(**stated, resolution_um=device.resolution_um, noise_um=noise_um,
                      delay_samples=late, stated=tuple(stated))  # fmt: skip
