"""What a rig adds to the force: a load cell that drifts, and a hum."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from springpot import Recording
from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.contact_point import find_contact
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.quality.noise_floor import sensor_noise_n

_LOWEST = 0.01  # of the travel: as low as the tool ever is
_DRIFT = 0.03  # of the peak force
_NOISES = 8.0
_EVEN = 0.35  # of a fall, in the second half of the time: less is no line
_ENDED = 0.1  # of it: nothing is left of the fall
_HUM_HZ = 20.0  # hands and presses are slower
_ABOVE_MOTION = 5.0  # times the highest frequency of the motion
_MOTION = 1e-4  # of the spectrum's greatest power: where motion ends
_TONE = 0.7  # of the power above motion that one tone has
_HUM = 0.01  # of the peak force: amplitude that hides the surface
_IN_MOTION = 0.3  # of the tone's force that the motion at its frequency explains
_BINS = 2  # on each side, of one tone
_FEWEST = 256  # samples of a spectrum


def rig_findings(recording: Recording) -> list[Finding]:
    """Return warnings of a hum, which hides the surface, and of a load cell that drifts."""
    hum = hum_of(recording)
    return [*(hum_findings(recording, hum) if hum else ()), *drift_findings(recording)]


def drift_findings(recording: Recording) -> Iterator[Finding]:
    """Yield a finding if force changes from visit to visit of the lowest position.

    An object that is pressed relaxes: where the tool is back, force is less than it was, and not
    below 0. So a rise is the load cell's, and so is a fall below 0 in the air that goes on evenly.
    Where the tool begins on the object, force may have been zeroed under load and relax, ever more
    slowly. The pull of what holds the tool lets go while the tool rests there.
    """
    visits = list(_visits(recording))
    if len(visits) < 3:
        return
    peak_n = float(np.ptp(recording.force_n))
    least_n = max(_DRIFT * peak_n, _NOISES * sensor_noise_n(recording.force_n))
    forces_n = np.array([float(np.median(recording.force_n[part])) for part in visits])
    tare_n = max(float(recording.details.get("tare_n", 0.0)), 0.0)  # of all visits together
    pushed = bool(forces_n[0] + tare_n > -least_n)  # what is pulled relaxes upwards
    rises = bool(np.all(np.diff(forces_n) > -least_n / 2.0))
    falls = bool(np.all(np.diff(forces_n) < least_n / 2.0)) and forces_n[-1] < -least_n
    holds = any(_rise_n(recording.force_n[part]) > least_n / 4.0 for part in visits)
    moved_n = float(forces_n[-1] - forces_n[0])
    fell = moved_n < -least_n and falls and not holds
    goes_on = _second_half(visits, forces_n)
    if fell and goes_on < _ENDED:
        return  # the force without contact, or that of an object which has relaxed: no line
    if not pushed or not (fell or (moved_n > least_n and rises)):
        return
    where, ends = recording.name, f"from {forces_n[0]:.3g} to {forces_n[-1]:.3g} N"
    untared = "tare before each press, or take the line off before the import"
    if fell and (goes_on < _EVEN or not _begins_off(recording, visits[1].start)):
        yield warning(
            "drift", where, f"force at the lowest position falls {ends}",
            "the load cell does that, and so does an object that relaxes after force was zeroed "
            "under load: the model would have it as slow memory, or pull",
            "if force was zeroed under load, import with --tare=-PRELOAD_N, the force that was "
            f"taken off; if the load cell drifts, {untared}",
        )  # fmt: skip
    else:
        yield warning(
            "drift", where, f"force at the lowest position drifts {ends}",
            "no object does that, the load cell does, and the model would have it as slow memory",
            untared,
        )  # fmt: skip


def _second_half(visits: Sequence[slice], forces_n: Samples) -> float:
    """Share of the change of force that the second half of the time has: 1/2 of a line."""
    times = np.array([0.5 * (part.start + part.stop) for part in visits])
    half_n = float(np.interp(0.5 * (times[0] + times[-1]), times, forces_n))
    changed_n = float(forces_n[-1] - forces_n[0])
    return float(forces_n[-1] - half_n) / changed_n if changed_n else 0.0


def _begins_off(recording: Recording, end: int) -> bool:
    """Whether the tool is off the object before its first press, the deepest of up to `end`."""
    deepest = int(np.argmax(recording.position_m[:end])) + 1
    position_m, force_n = recording.position_m[:deepest], recording.force_n[:deepest]
    try:
        find_contact(replace(recording, position_m=position_m, force_n=force_n, channels={}))
    except DataError:
        return False
    return True


def hum_of(recording: Recording) -> tuple[float, float] | None:
    """Frequency, Hz, and amplitude, N, of a tone in the force that the motion does not have."""
    n = len(recording.force_n)
    if n < _FEWEST or np.ptp(recording.position_m) == 0.0:
        return None
    window = np.hanning(n)
    force, position = (
        _spectrum(each, window) for each in (recording.force_n, recording.position_m)
    )
    power, moved = np.abs(force) ** 2, np.abs(position) ** 2
    hz = np.fft.rfftfreq(n, recording.dt_s)
    moving_hz = float(hz[np.flatnonzero(moved > _MOTION * moved.max())[-1]])
    above = hz > max(_HUM_HZ, _ABOVE_MOTION * moving_hz)
    if np.count_nonzero(above) < 4 * _BINS:
        return None
    at = int(np.argmax(np.where(above, power, 0.0)))
    tone = np.zeros(len(hz), dtype=bool)
    tone[max(at - _BINS, 0) : at + _BINS + 1] = True
    amplitude_n = 2.0 * float(np.sqrt(power[tone & above].sum() / np.sum(window**2) / n))
    stiffness_npm = float(np.ptp(recording.force_n) / np.ptp(recording.position_m))
    in_motion_n = stiffness_npm * 2.0 * float(np.sqrt(moved[tone].sum() / np.sum(window**2) / n))
    if (
        power[tone & above].sum() < _TONE * power[above].sum()
        or amplitude_n < _HUM * float(np.ptp(recording.force_n))
        or in_motion_n > _IN_MOTION * amplitude_n
    ):
        return None
    return float(hz[at]), amplitude_n


def hum_findings(recording: Recording, hum: tuple[float, float]) -> Iterator[Finding]:
    """Yield the finding of a hum: it hides the surface, which is not looked for then."""
    yield warning(
        "hum", recording.name,
        f"force swings by {hum[1]:.3g} N at {hum[0]:.3g} Hz, where the tool does not move",
        "a hum, which hides the surface and is fitted as noise",
        "shield or ground the load cell, or filter both channels alike before the import",
    )  # fmt: skip


def _spectrum(samples: Samples, window: Samples) -> NDArray[np.complex128]:
    return np.asarray(np.fft.rfft((samples - samples.mean()) * window))


def _rise_n(force_n: Samples) -> float:
    """Rise from the first to the last tenth of a visit, N."""
    tenth = max(1, len(force_n) // 10)
    return float(np.median(force_n[-tenth:]) - np.median(force_n[:tenth]))


def _visits(recording: Recording) -> Iterator[slice]:
    """Parts in which the tool is as low as it ever is; between them it goes a tenth higher."""
    position_m = recording.position_m
    low_m, travel_m = float(position_m.min()), float(np.ptp(position_m))
    if travel_m == 0.0:
        return
    low = np.flatnonzero(position_m <= low_m + _LOWEST * travel_m)
    ends = np.flatnonzero(np.diff(low) > 1)
    begin = int(low[0])
    for last, after in zip(low[ends], low[ends + 1], strict=True):
        if position_m[last:after].max() > low_m + 0.1 * travel_m:
            yield slice(begin, int(last) + 1)
            begin = int(after)
    yield slice(begin, int(low[-1]) + 1)
