"""`springpot run`: render a scene on a device, in real time, with a log."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot.codegen.errors import UsageError
from springpot.codegen.types import JsonObject
from springpot.host.devices.device import RECONNECT_S
from springpot.host.options import PATH, POSITIVE, device_option, scene_or_folder_option
from springpot.host.output import json_option, print_result, progress_console

if TYPE_CHECKING:
    from springpot.host.session.session import Session


@click.command()
@scene_or_folder_option
@device_option
@click.option("--seconds", type=POSITIVE, help="How long; by default until q or Ctrl-C.")
@click.option(
    "--place", metavar="X,Y", help="Of a scene with a map: where it is pressed, as 5,10mm."
)
@click.option("--log", type=PATH, help="File to write, ending in .h5.")
@click.option("--max-force-n", type=POSITIVE, help="End the session beyond this force, N.")
@click.option("--max-depth-mm", type=POSITIVE, help="End the session beyond this depth, mm.")
@click.option(
    "--reconnect-s",
    type=POSITIVE,
    default=RECONNECT_S,
    show_default=True,
    help="How long to wait for a device that was unplugged.",
)
@json_option
def run(
    scene: Path,
    url: str,
    seconds: float | None,
    place: str | None,
    log: Path | None,
    max_force_n: float | None,
    max_depth_mm: float | None,
    reconnect_s: float,
    as_json: bool,
) -> None:
    """Render a scene on a device.

    Keys: q stop, p pause, r reset; Ctrl-C stops too.
    """
    from springpot.host.emission.emission import emitted_folder
    from springpot.host.session.session import Session
    from springpot.host.session.terminal import stopping_on_sigterm
    from springpot.trainer.recordings.formats.importing import parse_place
    from springpot.trainer.recordings.recording import RECORDING_SUFFIX

    if log is not None and log.suffix != RECORDING_SUFFIX:
        raise UsageError(f"{log}: a log is a recording: give a name ending in {RECORDING_SUFFIX}")

    def report(line: str) -> None:
        if line != session.line:  # why it ended is printed once: in the table, or as the error
            _say_above(line)

    with emitted_folder(scene) as folder, stopping_on_sigterm():
        session = Session(
            folder,
            url,
            log,
            seconds=seconds or 0.0,
            max_force_n=max_force_n,
            max_depth_m=None if max_depth_mm is None else max_depth_mm / 1e3,
            reconnect_s=reconnect_s,
            report=report,
            place_m=parse_place(place) if place else None,
            alarm=_alarm,
        )
        _hold(session)
        result = session.result()
    rows = _rows(result)
    if session.error is not None:
        del rows["stopped"]
    print_result(result, as_json, rows)
    if session.error is not None:
        raise session.error


def _hold(session: Session) -> None:
    """Run a session to its end."""
    from springpot.host.session.terminal import watch

    try:
        with session:
            session.start()
            watch(session)
    except KeyboardInterrupt:
        if not session.line:  # it had not begun; else its line says that, and by whom
            raise


def _alarm(line: str) -> None:
    """A live warning, with the terminal's bell; an empty line where another message says it."""
    if line:
        _say_above(line)
    if progress_console.is_terminal:
        progress_console.bell()


def _say_above(line: str) -> None:
    progress_console.print(line, highlight=False, markup=False, soft_wrap=True)


def ticks_in_words(ticks: int, expected: int) -> str:
    """The loop follows a device's clock: a faster one makes more ticks than this computer's."""
    if ticks > expected:
        return f"{ticks} by the device's clock ({expected} by this computer's)"
    return f"{ticks} of {expected}"


def _felt(max_depth_m: float | None, max_force_n: float) -> str:
    """Say how deep a session was and how hard; a wrong surface or sign shows here."""
    if max_depth_m is None:
        return "nothing: no position came"
    if max_force_n == 0.0:
        return (
            f"no force: the deepest position was {1e3 * max_depth_m:.4g} mm; if the tool touched "
            "the object, its surface or the sign of the position is another"
        )
    return f"to {1e3 * max_depth_m:.4g} mm deep, to {max_force_n:.4g} N"


def _rows(result: JsonObject) -> dict[str, str]:
    """Return what a person reads of a session: its end, its timing, what was lost."""
    late, tick = result["lateness_us"], result["tick_us"]
    warned: dict[str, list[int]] = {}
    for item in result["warnings"]:
        warned.setdefault(item["what"], []).append(item["count"])
    warnings = [f"{what} ({len(ticks)} x, {sum(ticks)} ticks)" for what, ticks in warned.items()]
    return {
        "stopped": result["stopped"],
        "ticks": ticks_in_words(result["ticks"], result["expected_ticks"])
        + f", {result['late']} late",
        "lateness": f"{late['p50']:.0f} us, 99 % below {late['p99']:.0f}, worst {late['max']:.0f}"
        f" (the hypervisor took {result['steal_ms']:.0f} ms)",
        "tick": f"{tick['p50']:.1f} us, 99 % below {tick['p99']:.1f}",
        "samples": f"{result['samples']} came, {result['stale_samples']} ticks without a new one",
        "felt": _felt(result["max_depth_m"], result["max_force_n"]),
        "lost": f"{result['sequence_gaps']} frames missing, {result['crc_errors']} damaged, "
        f"{result['ring_dropped']} rows dropped",
        "watchdog": f"{result['watchdog_trips']} trips"
        + (", latched" if result["latched"] else ""),
        "warnings": "; ".join(warnings) or "none",
        "scheduler": result["scheduler"],
        "log": result["log"] or "none",
        **({"edited C": ", ".join(result["edited"])} if result["edited"] else {}),
    }
