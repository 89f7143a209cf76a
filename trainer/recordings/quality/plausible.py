"""What a recording says at a glance, and the unit that would make it usual."""

from dataclasses import dataclass

import numpy as np

from springpot.trainer.recordings.formats.units import Quantity, factor_to_si
from springpot.trainer.recordings.quality.finding import three_digits
from springpot.trainer.recordings.quality.motion import find_strokes
from springpot.trainer.recordings.recording import Recording

# Stiffness under a tip of a finger's size, 2 a E / (1 - nu^2) for a = 5 mm, from soft gels (1 kPa)
# to rubber of Shore A 80 (10 MPa); Johnson, Contact Mechanics, 1985, section 3.4.
USUAL_NPM = (10.0, 1e5)
_ARM_N, _MACHINE_MPS = 500.0, 1e-3  # an arm pushes with less; only machines are so slow
USUAL_MPS = 0.3  # a hand presses at up to this; a testing machine is slower
_LIKELY_NPM = (100.0, 3e4)
_STRAIN = 1.0  # numbers of position up to here may be a strain
# Which units may be meant, the likeliest first, where it is too stiff and where it is too soft.
_STIFF: tuple[tuple[Quantity, str], ...] = (
    ("force", "gf"),
    ("force", "mN"),
    ("position", "in"),
    ("position", "cm"),
    ("position", "m"),
)
_SOFT: tuple[tuple[Quantity, str], ...] = (
    ("force", "lbf"),
    ("force", "kgf"),
    ("force", "kN"),
    ("position", "um"),
)
_PLAIN: dict[Quantity, str] = {"force": "N", "position": "mm"}


@dataclass(frozen=True)
class Glance:
    """Stroke, greatest force and speed, and stiffness: force range over stroke.

    doubt: why that is unusual, and with which unit it were not; "" where it is usual.
    """

    stroke_m: float
    peak_n: float
    speed_mps: float
    stiffness_npm: float
    doubt: str

    @property
    def words(self) -> str:
        """One line for people."""
        text = (
            f"stroke {three_digits(self.stroke_m, 'm')}, peak {three_digits(self.peak_n, 'N')}, "
            f"up to {three_digits(self.speed_mps, 'm/s')}, "
            f"{three_digits(self.stiffness_npm, 'N/m')} in the mean"
        )
        return f"{text}: {self.doubt}" if self.doubt else text


def glance(recording: Recording) -> Glance:
    """Figures of a recording with a moving position.

    >>> position_m = 5e-3 * np.linspace(0, 1, 1000)
    >>> glance(Recording("a", position_m, 8e5 * position_m, 1e-3)).words
    'stroke 5 mm, peak 4 kN, up to 5.01 mm/s, 800 kN/m in the mean: stiffer than rubber under a \
    fingertip, as bone, cartilage and thin layers are; if force is in gf, it is 7.85 kN/m; \
    if force is in mN, it is 800 N/m; if position is in m, it is 800 N/m'
    """
    stroke_m = float(np.ptp(recording.position_m))
    stiffness_npm = float(np.ptp(recording.force_n)) / stroke_m if stroke_m else 0.0
    steps_m = np.abs(np.diff(recording.position_m))
    # Of a hundred samples one is noise; a fast stroke between long holds is in fewer.
    speed_mps = float(np.quantile(steps_m, 0.99)) / recording.dt_s
    speed_mps = max(speed_mps, *(stroke[2] for stroke in find_strokes(recording)), 0.0)
    return Glance(
        stroke_m,
        float(np.abs(recording.force_n).max()),
        speed_mps,
        stiffness_npm,
        _doubt(recording, stiffness_npm, speed_mps) if stroke_m else "",
    )


def _doubt(recording: Recording, stiffness_npm: float, speed_mps: float) -> str:
    low_npm, high_npm = USUAL_NPM
    if speed_mps > USUAL_MPS:
        return "faster than a hand presses, if time and position have their right units"
    stiff = stiffness_npm > high_npm
    peak_n = float(np.abs(recording.force_n).max())
    hard = not stiff and peak_n > _ARM_N and speed_mps > _MACHINE_MPS
    if stiffness_npm == 0.0 or (low_npm <= stiffness_npm <= high_npm and not hard):
        return ""
    if stiff:
        what = "stiffer than rubber under a fingertip, as bone, cartilage and thin layers are"
    elif hard:
        what = "harder than an arm pushes, as a testing machine does"
    else:
        what = "softer than a gel under a fingertip, as foam and tissue under a needle are"
    stored = recording.details.get("units", {})
    meant = []
    for channel, unit in _STIFF if stiff or hard else _SOFT:
        if hard and channel == "position":
            continue
        taken = stored.get(channel, {}).get("to_si") or factor_to_si(_PLAIN[channel], channel, "")
        times = factor_to_si(unit, channel, "") / abs(taken)
        other_npm = stiffness_npm * (times if channel == "force" else 1.0 / times)
        if _LIKELY_NPM[0] <= other_npm <= _LIKELY_NPM[1]:
            meant.append(f"if {channel} is in {unit}, it is {three_digits(other_npm, 'N/m')}")
    taken = stored.get("position", {}).get("to_si")
    if stiff and taken and np.ptp(recording.position_m) <= _STRAIN * abs(taken):
        meant.append("if position is a strain, give the height, --map position=COL:33mm")
    return "; ".join([what, *meant])
