"""What was found: each value with its interval of 95 %, or why there is none."""

from dataclasses import dataclass

WIDEST = 0.1  # half of an interval, of its value: beyond it there is no value


@dataclass(frozen=True)
class Identified:
    """One value with its interval. value: None if it was not found; why: the reason then.

    low, high: None if nothing is known.
    """

    value: float | None = None
    low: float | None = None
    high: float | None = None
    why: str = ""

    def as_json(self) -> dict[str, float | str | None]:
        """Return value, low and high; or value None, why, and the bounds that are known."""
        if self.value is not None:
            return {"value": self.value, "low": self.low, "high": self.high}
        bounds = {"low": self.low, "high": self.high}
        known = {name: bound for name, bound in bounds.items() if bound is not None}
        return {"value": None, "why": self.why, **known}


@dataclass(frozen=True)
class DeviceMeasured:
    """A device that was measured; each name with its unit, as in the scene's [device].

    bias_n: a force that always acts, positive where it pushes the tool out. position_noise_m:
    standard deviation at rest. residual_m, sensor_m: rms of what the fit leaves, and of what the
    position sensor explains of it.
    """

    mass_kg: Identified
    viscous_nspm: Identified
    coulomb_n: Identified
    delay_s: Identified
    position_step_m: Identified
    velocity_noise_mps: Identified
    force_sign: Identified
    max_force_n: Identified
    bias_n: Identified
    position_noise_m: float
    residual_m: float
    sensor_m: float

    @property
    def misfit(self) -> float:
        """How much more the fit leaves than the sensor explains; about 1 where the model holds."""
        return self.residual_m / self.sensor_m if self.sensor_m > 0 else 1.0


def judged(value: float, half_width: float, unit: str, scale: float, advice: str) -> Identified:
    """Return a value that cannot be negative, or why it is unknown. scale: of the printed unit."""
    value, half_width = float(value), float(half_width)
    low, high = max(0.0, value - half_width), value + half_width
    if half_width <= WIDEST * value:
        return Identified(value, low, high)
    if low == 0.0:
        why = f"below {scale * high:.2g} {unit}: {advice}"
    else:
        why = f"between {scale * low:.2g} and {scale * high:.2g} {unit}: {advice}"
    return Identified(None, low, high, why)
