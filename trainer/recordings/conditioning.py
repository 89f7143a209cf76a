"""Do what a user asks for on import: delays, and steps that take out what a rig adds to samples."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.contact_point import describe_hum, find_contact
from springpot.trainer.recordings.quality.channels import (
    CLIPPED_KEY,
    channel_findings,
    find_clipping,
    level_findings,
)
from springpot.trainer.recordings.quality.signs import find_sign_refusals
from springpot.trainer.recordings.quality.spikes import replace_spikes
from springpot.trainer.recordings.recording import Recording, Zero
from springpot.trainer.recordings.signals import Drift, find_drift

_ACCELERATION_WINDOW_S = 0.02  # over which acceleration is taken from positions
_MIN_WINDOW_SAMPLES = 7
_HIDES_SURFACE = ("stuck", "gone", "gap")  # kinds of findings
_MAX_UNCERTAINTY_FRACTION = 0.25  # of the deepest press: a bound of its surface


@dataclass(frozen=True)
class Conditioning:
    """Steps that a user asks for; none by default.

    position_delay_s, force_delay_s: how much later than the truth the channel was sampled, s; kept
    as metadata.
    align: take the stated delays out, not only note them.
    mass_kg: mass that moves beyond the load cell, kg; its inertial force is removed.
    tare: force without contact, N, or "auto": found out of contact.
    contact_force: force above the tare that marks the surface, N, or "auto": just above the noise.
    accept_signs: take signs that the data speak against as the rig's; each use repeats the line.

    >>> Conditioning(tare="auto", mass_kg=0.02).mass_kg
    0.02
    """

    position_delay_s: float = 0.0
    force_delay_s: float = 0.0
    align: bool = False
    mass_kg: float = 0.0
    tare: float | Literal["auto"] | None = None
    contact_force: float | Literal["auto"] | None = None
    accept_signs: bool = False


def condition(
    recording: Recording, options: Conditioning, zero: Zero = "none"
) -> tuple[Recording, list[str]]:
    """Apply what a user asked for on import, in order; return the recording and a line a step.

    zero: the sample of each channel that is subtracted. Spikes are replaced before all else: a zero
    from one of them once moved a recording by ten times its stroke. Raises UsageError for a contact
    point beside a zero, DataError if it cannot be found, or if spikes are too many to be replaced.
    """
    messages: list[str] = []
    if zero != "none" or options.tare is not None or options.contact_force is not None:
        measured, (recording, findings) = recording, replace_spikes(recording)
        for finding in findings:
            if finding.severity == "refusal":
                _raise_likelier_cause(measured, options.accept_signs)
                raise DataError(finding.text)
    if zero != "none":
        recording = _subtract_zero(recording, zero)
    recording = replace(
        recording,
        position_delay_s=recording.position_delay_s + options.position_delay_s,
        force_delay_s=recording.force_delay_s + options.force_delay_s,
    )
    if options.align:
        recording, line = _align_force(recording)
        messages.append(line)
    if options.mass_kg:
        recording, line = _remove_inertia(recording, options.mass_kg)
        messages.append(line)
    if options.tare is not None or options.contact_force is not None:
        try:
            recording, line = _set_contact_zero(recording, options)
        except DataError:
            _raise_likelier_cause(recording, options.accept_signs)
            raise
        messages.append(line)
    if options.accept_signs:
        recording = replace(recording, details={**recording.details, "accepted_signs": True})
    return recording, messages


def _raise_likelier_cause(recording: Recording, accepts_signs: bool) -> None:
    """Raise DataError for a fault of a channel that hides the surface, if there is one.

    A position that stood still once was called the mass of a tool, for force came before it.
    """
    faults = [*level_findings(recording)] or [*channel_findings(recording)]
    refused = [fault.text for fault in faults if fault.severity == "refusal"]
    if not (refused or accepts_signs):
        refused = find_sign_refusals([recording])
    hiding = [fault.text for fault in faults if fault.kind in _HIDES_SURFACE]
    for text in refused or hiding:
        raise DataError(text)


def _subtract_zero(recording: Recording, zero: Zero) -> Recording:
    """Subtract the first or the smallest sample from each channel."""
    pick = np.min if zero == "min" else lambda samples: samples[0]
    zero_m, zero_n = float(pick(recording.position_m)), float(pick(recording.force_n))
    return replace(
        recording,
        position_m=recording.position_m - zero_m,
        force_n=recording.force_n - zero_n,
        zero=zero,
        details={**recording.details, "zero_position_m": zero_m, "zero_force_n": zero_n},
    )


def _align_force(recording: Recording) -> tuple[Recording, str]:
    """Shift the force by the difference of the delays; samples without a partner are cut.

    Raises UsageError where no delay is stated, DataError for a recording that is shorter.
    """
    from scipy.interpolate import CubicSpline

    skew_s = recording.force_delay_s - recording.position_delay_s
    if skew_s == 0.0:
        raise UsageError("--align: no delay is stated: pass --force-delay-s or --position-delay-s")
    time_s = np.arange(len(recording.force_n)) * recording.dt_s
    inside = (time_s + skew_s >= 0.0) & (time_s + skew_s <= time_s[-1])
    if inside.sum() < 2:
        raise DataError(f"{recording.name}: is shorter than the delay of {skew_s:g} s: correct it")
    shifted = replace(
        recording,
        position_m=recording.position_m[inside],
        force_n=np.asarray(CubicSpline(time_s, recording.force_n)(time_s[inside] + skew_s)),
        channels={name: samples[inside] for name, samples in recording.channels.items()},
        position_delay_s=0.0,
        force_delay_s=0.0,
        details={**recording.details, "aligned_s": skew_s},
    )
    return shifted, (
        f"{recording.name}: force shifted by {skew_s * 1e3:g} ms against position, "
        f"{(~inside).sum()} samples at the end cut"
    )


def _remove_inertia(recording: Recording, mass_kg: float) -> tuple[Recording, str]:
    """Subtract m a: the cell also pushes the mass beyond it when it accelerates inwards.

    Raises DataError for a recording that is too short for an acceleration.
    """
    from scipy.signal import savgol_filter

    window = max(_MIN_WINDOW_SAMPLES, round(_ACCELERATION_WINDOW_S / recording.dt_s) | 1)
    if window > len(recording.position_m):
        raise DataError(f"{recording.name}: too short for an acceleration: leave out --mass-kg")
    inertia_n = mass_kg * np.asarray(
        savgol_filter(recording.position_m, window, 3, deriv=2, delta=recording.dt_s)
    )
    details = {**recording.details, "mass_beyond_load_cell_kg": mass_kg}
    return replace(recording, force_n=recording.force_n - inertia_n, details=details), (
        f"{recording.name}: inertia of {mass_kg:g} kg removed, up to "
        f"{np.abs(inertia_n).max():.3g} N (acceleration over {window * recording.dt_s:.3g} s)"
    )


def _set_contact_zero(recording: Recording, options: Conditioning) -> tuple[Recording, str]:
    """Take the force without contact off; with a contact force, put position 0 at the surface.

    Raises UsageError beside --zero, DataError if there is no surface.
    """
    tare_n = _parse_force_n(options.tare, "tare")
    threshold_n = _parse_force_n(options.contact_force, "contact_force")
    if recording.zero != "none":
        raise UsageError("--contact-force and --tare find the zero: leave out --zero")
    details, line = dict[str, Any](recording.details), f"{recording.name}: "
    sets_zero, contact, drifted_n = options.contact_force is not None, None, 0.0
    if tare_n is None and (drift_found := find_air_drift(recording, asked=True)):
        details |= {CLIPPED_KEY: find_clipping(recording)}  # which a line hides
        recording, drift = drift_found
        details |= {"drift_nps": drift.slope_nps, "drift_bound_nps": drift.bound_nps}
        line += f"drift of {60.0 * drift.slope_nps:.3g} N/min taken off, "
        drifted_n, tare_n = drift.start_n, None if sets_zero else 0.0
    if sets_zero or tare_n is None:
        contact = find_contact(recording, tare_n, threshold_n)
        tare_n = contact.tare_n
    details["tare_n"] = drifted_n + tare_n
    position_m, force_n = recording.position_m, recording.force_n - tare_n
    line += f"tare of {drifted_n + tare_n:.4g} N taken off"
    if contact is not None and sets_zero:
        position_m = position_m - contact.position_m
        details |= {
            "contact_position_m": contact.position_m,
            "contact_uncertainty_m": contact.uncertainty_m,
            "contact_force_n": contact.threshold_n,
        }
        line += (
            f", surface at {contact.position_m * 1e3:.4g} +- {contact.uncertainty_m * 1e3:.2g} mm, "
            f"where force passes {contact.threshold_n:.3g} N"
        )
    return replace(recording, position_m=position_m, force_n=force_n, details=details), line


def find_air_drift(recording: Recording, asked: bool = False) -> tuple[Recording, Drift] | None:
    """Return the recording without drift of its force in the air, and that; None without one.

    An object that relaxes, with its force zeroed under load, looks alike, but has no surface.
    """
    if recording.zero == "none" and (drift := find_drift(recording, asked)):
        time_s = np.arange(len(recording.force_n)) * recording.dt_s
        drift_n = drift.start_n + drift.slope_nps * time_s
        steady = replace(recording, force_n=recording.force_n - drift_n)
        with suppress(DataError):
            find_contact(steady)
            return steady, drift
    return None


def _parse_force_n(value: float | str | None, name: str) -> float | None:
    """Force that was stated, N; None if it is to be found. Raises UsageError for other words."""
    if value is None or value == "auto":
        return None
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = np.nan
    if not np.isfinite(number):
        raise UsageError(f"{name}={value!r}: give a force in N, or 'auto'")
    return number


def align_surfaces(
    recordings: Sequence[Recording], options: Conditioning
) -> tuple[list[Recording], str]:
    """Shift all recordings of one object to one common surface; also return a note for the user.

    A rig keeps its zero from press to press, and each press shows the surface within bounds of its
    own. If they have nothing in common each recording keeps its zero: so it was found, or the
    object had not recovered. At another place the surface may be another: those keep theirs too.
    Raises DataError if a bound is too wide for how deep the object was pressed.
    """
    shared, note = list(recordings), ""
    if options.contact_force == "auto":
        if len(recordings) > 1 and not any(recording.place_m for recording in recordings):
            shared, note = _average_surfaces(recordings)
        _require_known_surface(shared)
    return shared, note


def _average_surfaces(recordings: Sequence[Recording]) -> tuple[list[Recording], str]:
    """The recordings on the surface that all of their bounds allow, if there is one; a note."""
    surfaces_m = np.array([recording.details["contact_position_m"] for recording in recordings])
    uncertainties_m = np.array(
        [recording.details["contact_uncertainty_m"] for recording in recordings]
    )
    low_m, high_m = (
        float((surfaces_m - uncertainties_m).max()),
        float((surfaces_m + uncertainties_m).min()),
    )
    if low_m > high_m:
        return list(recordings), (
            "the surfaces differ by more than their bounds: each recording keeps its own as zero"
        )
    mean_m = np.average(surfaces_m, weights=1.0 / np.maximum(uncertainties_m, 1e-9) ** 2)
    surface_m = float(np.clip(mean_m, low_m, high_m))
    uncertainty_m = max(high_m - surface_m, surface_m - low_m)
    shared = {"contact_position_m": surface_m, "contact_uncertainty_m": uncertainty_m}
    moved = [
        replace(
            recording,
            position_m=recording.position_m + (contact_m - surface_m),
            details={**recording.details, **shared},
        )
        for recording, contact_m in zip(recordings, surfaces_m.tolist(), strict=True)
    ]
    return moved, (
        f"one surface for all {len(recordings)}, where their bounds meet: "
        f"{1e3 * surface_m:.4g} +- {1e3 * uncertainty_m:.2g} mm"
    )


def _require_known_surface(recordings: Sequence[Recording]) -> None:
    """Raise DataError where the surface is known less well than a share of the deepest press.

    A load cell that drifted by 0.6 N a minute once put it "at 9.5 +- 240 mm", in silence.
    """
    deepest_m = max(float(recording.position_m.max()) for recording in recordings)
    for recording in recordings:
        uncertainty_m = recording.details["contact_uncertainty_m"]
        if uncertainty_m > _MAX_UNCERTAINTY_FRACTION * deepest_m:
            raise DataError(
                f"{recording.name}: its surface is known to +- {1e3 * uncertainty_m:.2g} mm alone, "
                f"of {1e3 * deepest_m:.3g} mm that the object is pressed, "
                "for force without contact "
                f"{describe_hum(recording) or 'is noisy or drifts, or samples lie far apart'}: "
                "leave --contact-force out if position 0 is the surface, else press "
                "deeper, or record with less noise"
            )
