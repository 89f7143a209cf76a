"""The command `springpot record`: an object's protocol on a device, one recording a press."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot.codegen.messages import counted_noun, log_progress
from springpot.host.options import PATH, POSITIVE, device_option
from springpot.host.output import json_option, print_json, print_line, print_table, progress_bar

if TYPE_CHECKING:
    from springpot.host.recording.indentation import PressedDevice
    from springpot.host.recording.protocols import Profile
    from springpot.host.recording.session import PressQuality
    from springpot.host.session.runner import Progress as SessionProgress


@click.command()
@device_option
@click.option(
    "--protocol", required=True, help="paper, validation, extended, or a FILE.toml of profiles."
)
@click.option("--force", "sensor_url", help="Force sensor beside it: serial:///dev/ttyACM1.")
@click.option(
    "--find-surface",
    is_flag=True,
    help="Touch the surface with the tool three times first, the Enter key each time.",
)
@click.option("--out", type=PATH, required=True, help="Folder to write to.")
@click.option(
    "--seed",
    type=click.IntRange(0, 2**31 - 1),
    default=0,
    help="Of random commands, and of a simulated device's noise unless its URL has a seed.",
)
@click.option("--object", "object_name", help="What lies under a real device: for file names.")
@click.option(
    "--max-force-n",
    type=POSITIVE,
    help="Stop beyond this; default 1.3 x the command (1.7 x with --force).",
)
@click.option(
    "--max-depth-mm", type=POSITIVE, default=30.0, show_default=True, help="Stop beyond this depth."
)
@click.option(
    "--max-speed-mps",
    type=POSITIVE,
    help="Brake and stop beyond this speed into the object; default 0.6 (0.35 with --force).",
)
@json_option
def record(
    url: str,
    protocol: str,
    sensor_url: str | None,
    find_surface: bool,
    out: Path,
    seed: int,
    object_name: str | None,
    max_force_n: float | None,
    max_depth_mm: float,
    max_speed_mps: float | None,
    as_json: bool,
) -> None:
    """Drive a device under force control and write one recording for each profile.

    On a real device, the key q and Ctrl-C stop with zero force.
    """
    from springpot.host.recording.indentation import Limits
    from springpot.host.recording.protocols import load_protocol
    from springpot.host.recording.session import open_press_device, record_session
    from springpot.host.session.terminal import stopping_on_sigterm

    if find_surface:
        surface_mm = _touched_mm(url)
        print_line(f"surface_mm = {surface_mm:g}: also for [device] of a scene")
        url += f"{'&' if '?' in url else '?'}surface_mm={surface_mm:g}"
    limits = Limits(max_force_n, max_depth_mm / 1e3, max_speed_mps)
    profiles = load_protocol(protocol, seed)
    with (
        _sensor(sensor_url) as pressing,
        _progress(profiles) as (on_progress, on_press),
        stopping_on_sigterm(),
    ):
        device = open_press_device(
            url, seed, object_name or "object", limits, on_progress, pressing
        )
        qualities = record_session(device, url, protocol, profiles, out, on_press)
    if as_json:
        duration_s = sum(quality.duration_s for quality in qualities)
        print_json({"out": out, "recordings": qualities, "duration_s": duration_s})
    else:
        _print(qualities)


def _sensor(url: str | None) -> AbstractContextManager[Callable[..., PressedDevice] | None]:
    """Return a force sensor beside the device, opened; nothing without its URL."""
    if url is None:
        return nullcontext()  # on systems without fcntl too
    from springpot.host.recording.sensed_press import opened_sensor

    return opened_sensor(url)


@contextmanager
def _progress(
    profiles: Sequence[Profile],
) -> Iterator[tuple[Callable[[SessionProgress], None], Callable[[PressQuality], None]]]:
    """A bar over all presses; yields what shows a press as it goes on, and one that is over."""
    from springpot.host.session.terminal import progress_line

    total_s, done_s = round(sum(len(profile.command_n) for profile in profiles) / 1000), 0.0

    def on_progress(now: SessionProgress) -> None:
        log_progress(progress_line(now, "q stop"), round(done_s), total_s)

    def on_press(quality: PressQuality) -> None:
        nonlocal done_s
        done_s += quality.duration_s
        log_progress(quality.name, round(done_s), total_s)

    with progress_bar("record"):
        yield on_progress, on_press


def _touched_mm(url: str) -> float:
    """Let a person touch the surface with the tool, and return where it is, mm."""
    from springpot.host.recording.session import TOUCHES, find_surface
    from springpot.host.session.terminal import stopping_on_sigterm, wait_for_enter

    def touched(number: int) -> None:
        line = "put the tool on the surface, keep it still, press Enter"
        wait_for_enter(f"touch {number} of {TOUCHES}: {line}")

    with stopping_on_sigterm():
        return find_surface(url, touched)


def _print(qualities: Sequence[PressQuality]) -> None:
    """Print a row for each press: how deep, how hard, and how near to its command."""
    columns = ("recording", "s", "depth mm", "force N", "of", "tracking error N rms")
    rows = (
        (
            quality.name,
            f"{quality.duration_s:.2f}",
            f"{quality.max_depth_m * 1e3:.2f}",
            f"{quality.max_force_n:.2f}",
            f"{quality.max_command_n:.2f}",
            f"{quality.tracking_rms_n:.3f}",
        )
        for quality in qualities
    )
    print_table(columns, rows, names=0, width=100)
    click.echo(f"{counted_noun(len(qualities), 'recording')} in {qualities[0].file.parent}")
