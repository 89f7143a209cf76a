"""A recording session: the surface, a protocol on a device, a recording and its quality a press."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from springpot.codegen.arrays import rms
from springpot.codegen.errors import SpringpotError, UsageError
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import find_driver, parse_device
from springpot.host.devices.virtual import parse_url
from springpot.host.native.c_library import COLUMN, IDLE, LoopRows
from springpot.host.recording.indentation import (
    OPEN_LOOP,
    WATCHDOG_S,
    Limits,
    PressedDevice,
    press_step_functions,
)
from springpot.host.recording.protocols import RATE_HZ, Profile
from springpot.host.session.outcome import LoopSettings
from springpot.host.session.runner import Progress, SessionRunner
from springpot.host.simulation.bench import SimulatedBench
from springpot.trainer.recordings.journal import JournalWriter, journal_path, require_no_journal
from springpot.trainer.recordings.recording import (
    RECORDING_SUFFIX,
    Recording,
    require_recording_name,
    safe_recording_name,
)
from springpot.trainer.recordings.recording_file import read_recordings

TOUCHES = 3
_LONGEST_S, _MEAN_S = 600.0, 0.3
_STILL_M = 0.2e-3  # the tool moves no more than this while it is measured
_SAME_M = 1.0e-3  # three touches of one surface
_NO_FORCE_N = 1e-3


@dataclass(frozen=True)
class PressQuality:
    """Errors of one press against its command."""

    name: str
    file: Path
    samples: int
    duration_s: float
    max_depth_m: float
    max_force_n: float
    max_command_n: float
    tracking_rms_n: float


def open_press_device(
    url: str,
    default_seed: int = 0,
    object_name: str = "object",
    limits: Limits | None = None,
    on_progress: Callable[[Progress], None] = lambda _progress: None,
    pressing: Callable[..., PressedDevice] | None = None,
) -> PressedDevice | SimulatedBench:
    """Open the device of a URL; `default_seed` seeds a simulated one without a seed in its URL.

    object_name, limits: of the object under a device that is not simulated. on_progress: called
    several times a second while such a device presses. pressing: makes the device from (url,
    object_name, limits, on_progress) if its force is measured beside it.
    Raises DeviceError for a scheme that no driver serves, UsageError for a wrong URL.
    """
    scheme = parse_device(url).scheme
    if scheme == "sim":
        if pressing is not None:
            raise UsageError(f"{url}: it measures its force itself: leave --force out")
        return SimulatedBench(parse_url(url, default_seed))
    if scheme == "replay":
        raise UsageError(f"{url}: a recording cannot be pressed: give a device, or sim://OBJECT")
    return (pressing or PressedDevice)(url, object_name, limits or Limits(), on_progress)


def recorded_before(
    device: PressedDevice | SimulatedBench,
    source: str,
    protocol: str,
    profiles: Sequence[Profile],
    out: Path,
) -> list[Recording]:
    """Recordings that `record_session` would make, if `out` has them all; else none."""
    files = [out / f"{name}{RECORDING_SUFFIX}" for name in _names(device, protocol, profiles)]
    found = read_recordings(files) if all(file.exists() for file in files) else []
    simulated = isinstance(device, SimulatedBench)  # a real device's session is its time

    def is_same(recording: Recording, profile: Profile) -> bool:
        return (
            recording.source == source
            and recording.details.get("command") == dict(profile.metadata)
            and (recording.session == device.session or not simulated)
        )

    return found if all(map(is_same, found, profiles)) else []


def _names(
    device: PressedDevice | SimulatedBench, protocol: str, profiles: Sequence[Profile]
) -> list[str]:
    label = safe_recording_name(Path(protocol).stem)
    return [f"{device.object_name}-{label}-{profile.name}" for profile in profiles]


def record_session(
    device: PressedDevice | SimulatedBench,
    source: str,
    protocol: str,
    profiles: Sequence[Profile],
    out: Path,
    on_press: Callable[[PressQuality], None] = lambda _quality: None,
) -> list[PressQuality]:
    """Record every profile into the folder `out`, calling `on_press` after each.

    source, protocol: what `details` and names say of the origin; of a protocol's file, its name.
    Raises UsageError, before anything moves, where a recording would be overwritten.
    """
    label = safe_recording_name(Path(protocol).stem)
    names = _names(device, protocol, profiles)
    for name in names:
        require_recording_name(name)
    files = [out / f"{name}{RECORDING_SUFFIX}" for name in names]
    for file in files:
        if file.exists():
            raise UsageError(
                f"{file}: exists, with other settings or without the others of this protocol, and "
                "is not overwritten: read it, or give another folder"
            )
        require_no_journal(journal_path(file))
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{out}: {error.strerror}: give a folder") from None
    of_device = device.prepare()
    qualities = []
    for name, file, profile in zip(names, files, profiles, strict=True):
        if profile.place_m is not None:
            device.go_to(profile.place_m)
        details = {"protocol": label, "command": dict(profile.metadata), **of_device}
        dt_s = 1 / device.rate_hz
        place_m = device.place_m
        with JournalWriter(file, name, dt_s, source, details, place_m=place_m) as journal:
            position_m, force_n = device.press(profile.command_n, journal.append)
            journal.finish(session=device.session, start_s=device.start_s)
        recording = Recording(name, position_m, force_n, dt_s, source=source, details=details)
        qualities.append(_quality(file, recording, profile))
        on_press(qualities[-1])
    return qualities


def _quality(file: Path, recording: Recording, profile: Profile) -> PressQuality:
    """Return how deep and hard a press was, and how near its force was to the command."""
    command_n = profile.command_n[:: round(RATE_HZ * recording.dt_s)]  # one a sample
    error_n = recording.force_n - command_n
    return PressQuality(
        name=recording.name,
        file=file,
        samples=len(recording.force_n),
        duration_s=recording.duration_s,
        max_depth_m=float(recording.position_m.max()),
        max_force_n=float(recording.force_n.max()),
        max_command_n=float(profile.command_n.max()),
        tracking_rms_n=rms(error_n),
    )


def find_surface(url: str, touched: Callable[[int], None]) -> float:
    """Let a person touch the surface three times with the tool; return where it is, mm.

    touched: called with the number of each touch, from 1; returns when the tool is there. The
    device gives no force. Raises UsageError for a device or a URL that has its surface already,
    SpringpotError where the device fails, the tool moves, or the touches differ.
    """
    if find_driver(url).virtual:
        raise UsageError(f"{url}: its surface is at 0: leave --find-surface out")
    if "surface_mm" in parse_device(url).settings:
        raise UsageError(f"{url}: leave surface_mm out of the URL, or --find-surface")
    steps = press_step_functions(np.zeros(1), _NO_FORCE_N, OPEN_LOOP)
    settings = LoopSettings(1 / RATE_HZ, _LONGEST_S, _NO_FORCE_N)
    required = DeviceRequirements(RATE_HZ, WATCHDOG_S, _NO_FORCE_N, examined=True)
    newest, places_m = deque[LoopRows](maxlen=20), list[float]()
    runner = SessionRunner(steps, url, required, settings, [newest.append], reconnect_s=0.0)
    with runner:
        runner.start()
        for number in range(1, TOUCHES + 1):
            touched(number)
            runner.wait(1.5 * _MEAN_S)
            if runner.over:
                break
            places_m.append(_place_m(tuple(newest), url))
    line, error = runner.why()
    if error is not None or len(places_m) < TOUCHES:
        raise error or SpringpotError(f"{url}: {line}")
    if max(places_m) - min(places_m) > _SAME_M:
        surfaces = ", ".join(f"{1e3 * place_m:.2f}" for place_m in places_m)
        raise SpringpotError(
            f"{url}: the touches are at {surfaces} mm, more than {1e3 * _SAME_M:g} mm from each "
            "other: touch the same place, lightly"
        )
    return round(1e3 * float(np.median(places_m)), 3)


def _place_m(tables: Sequence[LoopRows], url: str) -> float:
    """Return where the tool is held still; tables: the last rows of the loop."""
    rows = np.concatenate([np.empty((0, len(COLUMN))), *tables])
    sampled = (rows[:, COLUMN["call"]].astype(int) & IDLE) == 0
    position_m = rows[sampled, COLUMN["position_m"]][-round(_MEAN_S * RATE_HZ) :]
    if not len(position_m) or not np.isfinite(position_m).all():
        raise SpringpotError(f"{url}: no positions come: check its power and cable")
    if np.ptp(position_m) > _STILL_M:
        raise SpringpotError(
            f"{url}: the tool moved by {1e3 * np.ptp(position_m):.2f} mm while it was "
            "measured: keep it still on the surface until the next line"
        )
    return float(position_m.mean())
