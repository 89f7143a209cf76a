"""A recording session: drive a device through a protocol, one recording and its quality a press."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.arrays import rms
from springpot.codegen.errors import UsageError
from springpot.host.devices.drivers import parse_device
from springpot.host.recording.indentation import Limits, PressedDevice
from springpot.host.recording.protocols import RATE_HZ, Profile
from springpot.host.session.runner import Progress
from springpot.host.simulation.bench import SimulatedBench
from springpot.host.simulation.objects import parse_url
from springpot.trainer.recordings.journal import JournalWriter
from springpot.trainer.recordings.recording import (
    RECORDING_SUFFIX,
    Recording,
    require_recording_name,
    safe_recording_name,
)
from springpot.trainer.recordings.recording_file import journal_of, require_no_journal


@dataclass(frozen=True)
class PressQuality:
    """How well one press followed its command."""

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
    """Open the device of a URL; `default_seed` seeds a simulated one whose URL has no seed.

    object_name, limits: of what lies under a device that is not simulated. on_progress: called
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
    names = [f"{device.object_name}-{label}-{profile.name}" for profile in profiles]
    for name in names:
        require_recording_name(name)
    files = [out / f"{name}{RECORDING_SUFFIX}" for name in names]
    for file in files:
        if file.exists():
            raise UsageError(f"{file}: exists and is not overwritten: give another --out")
        require_no_journal(journal_of(file))
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{out}: {error.strerror}: give a folder for --out") from None
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
    command_n = profile.command_n[:: round(RATE_HZ * recording.dt_s)]
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
