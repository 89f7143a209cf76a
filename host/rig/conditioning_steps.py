"""Removal of what a rig adds to samples: delays, mass beyond the load cell, give, offset, surface.

Each step is reported in one line and kept in the recording's details.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from springpot import Recording
from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.conditioning import Conditioning
from springpot.trainer.recordings.contact_point import find_contact
from springpot.trainer.recordings.quality.signs import require_signs

_SMOOTH_S = 0.02  # over which acceleration is taken from positions
_MIN_WINDOW = 7


def without_rig(recording: Recording, options: Conditioning) -> tuple[Recording, list[str]]:
    """Return the recording without what the options name of the rig, and a line about each step.

    Raises UsageError for a contact point beside --zero, DataError where one cannot be found.
    """
    messages: list[str] = []
    if options.align:
        recording = _aligned(recording, messages)
    if options.mass_kg:
        recording = _without_inertia(recording, options.mass_kg, messages)
    if options.tare is not None or options.contact_force is not None:
        recording = _from_contact(recording, options, messages)
    if options.frame_npm:  # of the force without its tare: the surface, where it is 0, stays
        recording = _without_give(recording, options.frame_npm, messages)
    return recording, messages


def _aligned(recording: Recording, messages: list[str]) -> Recording:
    """Shift the force by the difference of the delays; samples without a partner are cut."""
    from scipy.interpolate import CubicSpline

    skew_s = recording.force_delay_s - recording.position_delay_s
    if skew_s == 0.0:
        raise UsageError("--align: no delay is stated: pass --force-delay-s or --position-delay-s")
    time_s = np.arange(len(recording.force_n)) * recording.dt_s
    inside = (time_s + skew_s >= 0.0) & (time_s + skew_s <= time_s[-1])
    if inside.sum() < 2:
        raise DataError(f"{recording.name}: is shorter than the delay of {skew_s:g} s: correct it")

    def shifted(force_n: Samples) -> Samples:
        return np.asarray(CubicSpline(time_s, force_n)(time_s[inside] + skew_s))

    messages.append(
        f"{recording.name}: force shifted by {skew_s * 1e3:g} ms against position, "
        f"{(~inside).sum()} samples at the end cut"
    )
    return replace(
        recording,
        position_m=recording.position_m[inside],
        force_n=shifted(recording.force_n),
        channels={name: samples[inside] for name, samples in recording.channels.items()},
        position_delay_s=0.0,
        force_delay_s=0.0,
        details={**recording.details, "aligned_s": skew_s},
    )


def _without_inertia(recording: Recording, mass_kg: float, messages: list[str]) -> Recording:
    """Subtract m a: the cell also pushes the mass beyond it when it accelerates inwards."""
    from scipy.signal import savgol_filter

    window = max(_MIN_WINDOW, round(_SMOOTH_S / recording.dt_s) | 1)
    if window > len(recording.position_m):
        raise DataError(f"{recording.name}: too short for an acceleration: leave out --mass-kg")
    acceleration_mps2: Samples = savgol_filter(
        recording.position_m, window, 3, deriv=2, delta=recording.dt_s
    )
    inertia_n = mass_kg * acceleration_mps2
    messages.append(
        f"{recording.name}: inertia of {mass_kg:g} kg removed, up to "
        f"{np.abs(inertia_n).max():.3g} N (acceleration over {window * recording.dt_s:.3g} s)"
    )
    return replace(
        recording,
        force_n=recording.force_n - inertia_n,
        details={**recording.details, "mass_beyond_load_cell_kg": mass_kg},
    )


def _without_give(recording: Recording, frame_npm: float, messages: list[str]) -> Recording:
    """Subtract F/k: a frame that yields adds its way to that of the object."""
    give_m = recording.force_n / frame_npm
    depth_m, most_m = float(np.ptp(recording.position_m)), float(np.ptp(give_m))
    if most_m >= depth_m:
        raise DataError(
            f"{recording.name}: a frame of {frame_npm:g} N/m gives {most_m * 1e3:.3g} mm, but the "
            f"whole travel is {depth_m * 1e3:.3g} mm: state the frame's stiffness in N/m"
        )
    messages.append(
        f"{recording.name}: {most_m * 1e3:.3g} mm of the travel of {depth_m * 1e3:.3g} mm were the "
        f"frame's give at {frame_npm:g} N/m: removed"
    )
    return replace(
        recording,
        position_m=recording.position_m - give_m,
        details={**recording.details, "frame_npm": frame_npm},
    )


def _stated_n(value: float | str | None, name: str) -> float | None:
    """Force that was stated, N; None where it is to be found. Raises UsageError for other words."""
    if value is None or value == "auto":
        return None
    if isinstance(value, str) or not np.isfinite(value):
        raise UsageError(f"{name}={value!r}: give a force in N, or 'auto'")
    return float(value)


def _from_contact(recording: Recording, options: Conditioning, messages: list[str]) -> Recording:
    if recording.zero != "none":
        raise UsageError("--contact-force and --tare find the zero: leave out --zero")
    stated_n = _stated_n(options.tare, "tare")
    threshold_n = _stated_n(options.contact_force, "contact_force")
    if options.contact_force is None and stated_n is not None:
        messages.append(f"{recording.name}: tare of {stated_n:g} N taken off")
        details: dict[str, Any] = {**recording.details, "tare_n": stated_n}
        return replace(recording, force_n=recording.force_n - stated_n, details=details)
    try:
        found = find_contact(recording, stated_n, threshold_n)
    except DataError:
        if not options.accept_signs:
            require_signs([recording])  # a turned sign is the cause, and has another remedy
        raise
    details = {**recording.details, "tare_n": found.tare_n}
    position_m = recording.position_m
    messages.append(f"{recording.name}: tare of {found.tare_n:.4g} N taken off")
    if options.contact_force is not None:
        position_m = position_m - found.position_m
        details |= {
            "contact_position_m": found.position_m,
            "contact_uncertainty_m": found.uncertainty_m,
            "contact_force_n": found.threshold_n,
        }
        messages[-1] += (
            f", surface at {found.position_m * 1e3:.4g} +- {found.uncertainty_m * 1e3:.2g} mm, "
            f"where force passes {found.threshold_n:.3g} N"
        )
    force_n = recording.force_n - found.tare_n
    return replace(recording, position_m=position_m, force_n=force_n, details=details)
