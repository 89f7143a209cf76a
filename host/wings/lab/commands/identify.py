"""`springpot identify`: a device that nobody holds, moved and measured."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from springpot import SpringpotError, UsageError
from springpot.console import POSITIVE, json_option, print_result, say

if TYPE_CHECKING:
    from springpot.host.wings.lab.identification.excitation import MoveLimits
    from springpot.host.wings.lab.identification.result import DeviceMeasured, Identified

_RATE_HZ = 1000.0  # where the scene says none
_MIN_RATE_HZ = 100.0
_MAX_MISFIT = 50.0  # friction of any kind leaves less
# Names of the result: what a person reads, the unit, and how many of it are one of ours.
_ROWS = {
    "mass_kg": ("mass", "kg", 1.0),
    "viscous_nspm": ("viscous friction", "N s/m", 1.0),
    "coulomb_n": ("Coulomb friction", "N", 1.0),
    "delay_s": ("delay", "ms", 1e3),
    "position_step_m": ("step of position", "um", 1e6),
    "velocity_noise_mps": ("noise of velocity", "m/s", 1.0),
    "force_sign": ("sign of the force", "", 1.0),
    "max_force_n": ("largest force", "N", 1.0),
    "bias_n": ("force that always acts", "N", 1.0),
}


@click.command()
@click.option("--device", "url", required=True, help="Such as serial:///dev/ttyACM0, sim://free.")
@click.option(
    "--max-force-n", type=POSITIVE, default=2.0, show_default=True, help="No force beyond, N."
)
@click.option(
    "--max-travel-mm",
    type=POSITIVE,
    default=20.0,
    show_default=True,
    help="No force farther from where it begins, mm to either side.",
)
@click.option("--yes", is_flag=True, help="Do not ask: the device is free to move.")
@click.option(
    "--scene",
    type=click.Path(path_type=Path),
    help="Scene file: its [device] is read for the drive, and gets the keys found.",
)
@json_option
def identify(
    url: str,
    max_force_n: float,
    max_travel_mm: float,
    yes: bool,
    scene: Path | None,
    as_json: bool,
) -> None:
    """Measure a device that nobody holds: mass, friction, delay, sensors. It moves by itself."""
    from springpot import Device, read_scene
    from springpot.console import stopping_on_sigterm
    from springpot.devices import parse_device
    from springpot.host.wings.lab.identification.excitation import MoveLimits
    from springpot.host.wings.lab.identification.experiment import identify_device
    from springpot.host.wings.lab.identification.free_session import FreeSession
    from springpot.host.wings.lab.identification.keys import (
        device_keys,
        require_writable_device,
        write_keys,
    )

    parse_device(url)
    rendered = None if scene is None else read_scene(scene)
    if scene is not None:
        require_writable_device(scene)
    rate_hz = (rendered.runtime.rate_hz if rendered else None) or _RATE_HZ
    if rate_hz < _MIN_RATE_HZ:
        raise UsageError(
            f"{scene}: runtime.rate_hz = {rate_hz:g}: the test takes {_MIN_RATE_HZ:g} Hz or more"
        )
    limits = MoveLimits(max_force_n, max_travel_mm / 1e3)
    _ask_consent(url, limits, yes)
    session = FreeSession(url, rendered.device if rendered else Device())
    with stopping_on_sigterm():
        measured = identify_device(session, limits, rate_hz, url, say)
    if measured.misfit > _MAX_MISFIT:
        raise SpringpotError(
            f"{url}: what moved is no free device (it leaves {measured.misfit:.2g} times what its "
            "sensors explain): let go of it, take away what it touches, and try again"
        )
    keys = device_keys(measured)
    error = None
    if scene is not None:
        try:
            write_keys(scene, keys)
        except (SpringpotError, OSError) as failed:
            error, scene = failed, None
    print_result(_as_json(measured, url, limits, keys, scene), as_json, _as_rows(measured))
    if not as_json:
        _say_keys(measured, keys, scene)
    if error is not None:
        raise error


def _say_keys(measured: DeviceMeasured, keys: dict[str, float | int], scene: Path | None) -> None:
    from springpot.host.wings.lab.identification.keys import keys_as_toml

    if measured.misfit > 1.5:
        say(
            f"the device is not quite as the model: it leaves {measured.misfit:.2g} times what the "
            "sensors explain (friction that changes with place or at rest, play): the intervals "
            "are wider by that"
        )
    click.echo(f"written to {scene}" if scene else keys_as_toml(keys))


def _ask_consent(url: str, limits: MoveLimits, yes: bool) -> None:
    say(
        f"{url}: its tool will move by itself for about 15 s, with at most "
        f"{limits.max_force_n:g} N and {1e3 * limits.max_travel_m:g} mm to either side of where it "
        "is now. Nobody may hold it, and nothing may be in its way. q or Ctrl-C stops."
    )
    if yes:
        return
    if not sys.stdin.isatty():
        raise UsageError("identify moves the device: without a terminal to ask at, give --yes")
    answer = click.prompt("Enter or y to start", default="y", show_default=False, err=True)
    if answer.strip().lower() not in ("y", "yes"):
        raise UsageError("not started: nothing moved")


def _as_json(
    measured: DeviceMeasured,
    url: str,
    limits: MoveLimits,
    keys: dict[str, float | int],
    scene: Path | None,
) -> dict[str, Any]:
    found = {name: getattr(measured, name).as_json() for name in _ROWS}
    return found | {
        "device": url,
        "limit_n": limits.max_force_n,
        "limit_m": limits.max_travel_m,
        "position_noise_m": measured.position_noise_m,
        "residual_m": measured.residual_m,
        "sensor_m": measured.sensor_m,
        "misfit": measured.misfit,
        "keys": keys,
        "scene": None if scene is None else str(scene),
    }


def _as_rows(measured: DeviceMeasured) -> dict[str, str]:
    return {
        words: _in_words(getattr(measured, name), unit, scale)
        for name, (words, unit, scale) in _ROWS.items()
    }


def _in_words(found: Identified, unit: str, scale: float) -> str:
    if found.value is None:
        return f"not found: {found.why}"
    text = f"{scale * found.value:.4g} {unit}".rstrip()
    if found.low is None or found.high is None or found.low == found.high:
        return text
    return f"{text} +- {scale * (found.high - found.low) / 2:.2g} (95 %)"
