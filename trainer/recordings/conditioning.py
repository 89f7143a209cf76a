"""What a user asks for on import: delays, and steps that take out what a rig adds to samples."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from springpot.codegen.entry_points import required_part
from springpot.trainer.recordings.recording import Recording


@dataclass(frozen=True)
class Conditioning:
    """Steps that a user asks for; none by default.

    position_delay_s, force_delay_s: how much later than the truth the channels were sampled; kept
    as metadata, and with `align` also taken out.
    mass_kg: of what moves beyond the load cell; its inertial force is removed.
    frame_npm: stiffness of the machine's frame, N/m: its give under the force is removed; 0: rigid.
    tare: force without contact, N, or "auto": found out of contact.
    contact_force: force above the tare that marks the surface, N, or "auto": just above the noise.
    accept_signs: signs that the data speak against are those of the rig; said wherever it is used.

    >>> Conditioning(tare="auto", mass_kg=0.02).mass_kg
    0.02
    """

    position_delay_s: float = 0.0
    force_delay_s: float = 0.0
    align: bool = False
    mass_kg: float = 0.0
    frame_npm: float = 0.0
    tare: float | Literal["auto"] | None = None
    contact_force: float | Literal["auto"] | None = None
    accept_signs: bool = False

    def steps(self) -> list[str]:
        """Options of `springpot import` that change samples, as far as they are given."""
        given = {
            "--align": self.align,
            "--mass-kg": self.mass_kg,
            "--tare": self.tare is not None,
            "--contact-force": self.contact_force is not None,
            "--compliance": self.frame_npm,
        }
        return [option for option, is_given in given.items() if is_given]


def condition(recording: Recording, options: Conditioning) -> tuple[Recording, list[str]]:
    """Return the recording with everything done, and a line about each step.

    Raises UsageError for a contact point beside --zero, DataError where one cannot be found.
    """
    messages: list[str] = []
    recording = replace(
        recording,
        position_delay_s=recording.position_delay_s + options.position_delay_s,
        force_delay_s=recording.force_delay_s + options.force_delay_s,
    )
    if steps := options.steps():
        without_rig = required_part("conditioning", ", ".join(steps))
        recording, messages = without_rig(recording, options)
    if options.accept_signs:
        recording = replace(recording, details={**recording.details, "accepted_signs": True})
    return recording, messages


def on_one_surface(
    recordings: Sequence[Recording], options: Conditioning
) -> tuple[list[Recording], str]:
    """Give recordings of one object the mean surface within the bounds of all, and a line on it.

    A rig keeps its zero from press to press, and each press shows the surface within bounds of its
    own. If they have nothing in common each recording keeps its zero: so it was found, or the
    object had not recovered. At another place the surface may be another: those keep theirs too.
    """
    found = [recording.details for recording in recordings]
    met = options.contact_force == "auto" and all("contact_position_m" in each for each in found)
    placed = any(each.place_m for each in recordings)
    if not met or placed or len(recordings) < 2:
        return list(recordings), ""
    low_m = max(each["contact_position_m"] - each["contact_uncertainty_m"] for each in found)
    high_m = min(each["contact_position_m"] + each["contact_uncertainty_m"] for each in found)
    if low_m > high_m:
        return list(recordings), (
            "the surfaces differ by more than their bounds: each recording keeps its own as zero"
        )
    found_m = np.array([each["contact_position_m"] for each in found])
    weights = 1.0 / np.maximum([each["contact_uncertainty_m"] for each in found], 1e-9) ** 2
    surface_m = float(np.clip(np.average(found_m, weights=weights), low_m, high_m))
    doubt_m = max(high_m - surface_m, surface_m - low_m)
    shared = {"contact_position_m": surface_m, "contact_uncertainty_m": doubt_m}
    moved = [
        replace(
            recording,
            position_m=recording.position_m + (each["contact_position_m"] - surface_m),
            details={**each, **shared},
        )
        for recording, each in zip(recordings, found, strict=True)
    ]
    return moved, (
        f"one surface for all {len(recordings)}, where their bounds meet: "
        f"{1e3 * surface_m:.4g} +- {1e3 * doubt_m:.2g} mm"
    )
