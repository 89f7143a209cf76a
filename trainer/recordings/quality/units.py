"""Check that the units of a recording make a press that a rig can make and an object can answer."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from springpot.trainer.recordings.formats.units import format_map_option
from springpot.trainer.recordings.quality.finding import Finding, format_si, refusal, warning
from springpot.trainer.recordings.recording import Recording

# Beyond these a unit is doubted. Micrometres, millinewtons and 20 000 N load cells are real.
_TRAVEL_M, _FORCE_N, _RATE_HZ = (1e-6, 1.0), (1e-5, 2e4), (0.05, 1e6)
_SPEED_MPS, _STIFFNESS_NPM = (0.0, 3.0), (0.1, 1.2e6)  # cartilage has 1e6 under a tool of 8 mm
_USUAL_HZ = (5.0, 1e6)  # slower stamps may be sample numbers, read as s
_LONG_S = 3600.0  # of a test that is logged once a second
_QUASI_STATIC_MPS = 1e-3  # such tests are logged slowly; an arm is faster
_MOVING_STEP_FRACTION = 0.05  # of the largest step between samples: smaller ones are rests
# Stiffness under a tip of a finger's size, 2 a E / (1 - nu^2) for a = 5 mm, from soft gels (1 kPa)
# to rubber of Shore A 80 (10 MPa); Johnson, Contact Mechanics, 1985, section 3.4.
_FINGERTIP_NPM = (10.0, 1e5)
_ARM_N, _HAND_MPS = 500.0, 0.3  # an arm pushes with less; a hand presses more slowly
_TOO_STIFF_TEXT = (
    "stiffer than rubber under a fingertip, unless force is in gf, force is in mN, position is in "
    "in, position is in cm, position is in m, or it is a strain"
)
_TOO_SOFT_TEXT = "softer than a gel under a fingertip, unless force is in kN or position is in um"


@dataclass(frozen=True)
class PressSummary:
    """Stroke, greatest force and speed, and stiffness: range of force over stroke."""

    stroke_m: float
    peak_n: float
    speed_mps: float
    stiffness_npm: float

    @property
    def words(self) -> str:
        """One line for people: the figures, and why they are none of a hand's."""
        text = (
            f"stroke {format_si(self.stroke_m, 'm')}, peak {format_si(self.peak_n, 'N')}, "
            f"up to {format_si(self.speed_mps, 'm/s')}, "
            f"{format_si(self.stiffness_npm, 'N/m')} in the mean"
        )
        if self.speed_mps > _HAND_MPS:
            return f"{text}: faster than a hand presses, unless time or position has another unit"
        if self.stiffness_npm > _FINGERTIP_NPM[1]:
            return f"{text}: {_TOO_STIFF_TEXT}"
        if self.peak_n > _ARM_N and self.speed_mps > _QUASI_STATIC_MPS:
            return f"{text}: harder than an arm pushes, unless force is in gf or force is in mN"
        return f"{text}: {_TOO_SOFT_TEXT}" if 0.0 < self.stiffness_npm < _FINGERTIP_NPM[0] else text


def summarise_press(recording: Recording) -> PressSummary:
    """Figures of a recording; of the steps of a moving tool, one in a hundred is noise.

    >>> position_m = 5e-3 * np.linspace(0, 1, 1000)
    >>> glance(Recording("a", position_m, 8e3 * position_m, 1e-3)).words
    'stroke 5 mm, peak 40 N, up to 5.01 mm/s, 8 kN/m in the mean'
    """
    stroke_m = float(np.ptp(recording.position_m))
    steps_m = np.abs(np.diff(recording.position_m))
    fastest_m = float(np.quantile(steps_m[steps_m >= _MOVING_STEP_FRACTION * steps_m.max()], 0.99))
    stiffness_npm = float(np.ptp(recording.force_n)) / stroke_m if stroke_m else 0.0
    peak_n = float(np.abs(recording.force_n).max())
    return PressSummary(stroke_m, peak_n, fastest_m / recording.dt_s, stiffness_npm)


def unit_findings(recording: Recording) -> Iterator[Finding]:
    """Refuse a unit that was read off a header; warn of one that was stated, and of odd ratios."""
    summary, stored = summarise_press(recording), recording.details.get("units", {})
    singles = (
        (summary.stroke_m, _TRAVEL_M, "m of travel", "position"),
        (summary.peak_n, _FORCE_N, "N of peak force", "force"),
        (recording.rate_hz, _RATE_HZ, "samples a second", "time"),
    )
    rate_hz = _USUAL_HZ[0] if _is_quasi_static(recording, summary) else recording.rate_hz
    ratios = (
        (rate_hz, _USUAL_HZ, "samples a second", "time"),
        (summary.speed_mps, _SPEED_MPS, "m/s of pressing", "position or time"),
        (summary.stiffness_npm, _STIFFNESS_NPM, "N/m of stiffness", "position or force"),
    )
    possible = all(low <= value <= high for value, (low, high), _, _ in singles)
    for value, (low, high), what, channels in ratios if possible else singles:
        if not low <= value <= high:
            doubt, origin = f"the unit of {channels} looks wrong", stored.get(channels, {})
            finding, to_do = warning, "check it against the rig, and state it on import (--map)"
            if not possible and origin.get("from", "device") not in ("map", "device"):
                column, unit = origin.get("column", "COL"), origin["unit"]
                right = format_map_option(channels, column, unit)
                other = format_map_option(channels, column, f"FACTOR{unit}")
                finding = refusal
                to_do = f"state it, {right} if the header is right, else {other}, such as 0.001"
            yield finding("unit", recording.name, f"{value:.4g} {what}", doubt, to_do)


def _is_quasi_static(recording: Recording, summary: PressSummary) -> bool:
    """Return whether a low rate is that of a slow test, and stamps are no numbers of samples.

    Those are whole numbers, slow logs have digits behind the point; what was never printed, 0,
    shows neither. Digits that are all 0 are printed by a format: over hours it is doubted too.
    """
    sampling = recording.details.get("sampling", {})
    whole = sampling.get("longest_step_s") == sampling.get("shortest_step_s") == 1.0
    numbered = not 0.0 < sampling.get("stamp_digit_s", 0.0) < 1.0
    numbered |= whole and recording.duration_s > _LONG_S
    slow = summary.speed_mps < _QUASI_STATIC_MPS and not numbered
    return slow or "resampled_hz" in recording.details
