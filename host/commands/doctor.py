"""`springpot doctor`: what this machine offers, and what to do where something is missing."""

import os
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import click

from springpot.codegen.native.compiler import (
    CompilerError,
    cache_folder,
    compiler_reason,
    compiler_version,
    find_compiler,
)
from springpot.host.native.toolchain import PROGRAMS
from springpot.host.output import json_option, print_json, print_table


@dataclass(frozen=True)
class Diagnosis:
    """One row: what was looked for, whether it is fine, what was seen, and what to do if not."""

    what: str
    found: bool
    seen: str
    do: str = ""


@click.command()
@json_option
def doctor(as_json: bool) -> None:
    """Show what this machine offers, and what to do where something is missing."""
    findings = list(examine())
    if as_json:
        print_json({"findings": findings})
    else:
        rows = [(item.what, "ok" if item.found else "--", item.seen, item.do) for item in findings]
        print_table(("what", "", "seen", "what to do"), rows)
    if not findings[0].found:
        sys.exit(1)


def examine() -> Iterator[Diagnosis]:
    """Look at everything that springpot uses on this machine; the compiler first."""
    from serial.tools import list_ports

    try:
        compiler = find_compiler()
        seen = f"{' '.join(compiler)}: {compiler_version(compiler)} ({compiler_reason()})"
        yield Diagnosis("C compiler", True, seen)
    except CompilerError as error:
        yield Diagnosis("C compiler", False, "none", str(error))
    folder = cache_folder()
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    writable = os.access(folder, os.W_OK)
    do = "" if writable else "set XDG_CACHE_HOME to a folder that you can write"
    yield Diagnosis("library cache", writable, f"{folder}: {len([*folder.glob('*.so')])} built", do)
    yield from _scheduling()
    yield _timer()
    ports = [_serial_port(port.device, port.description) for port in list_ports.comports()]
    yield from ports or [Diagnosis("serial ports", False, "none", "plug the device in")]
    for program, (package, why) in PROGRAMS.items():
        path = shutil.which(program)
        how = f"`apt-get install {package}`" if sys.platform == "linux" else f"install {package}"
        do = "" if path else how
        yield Diagnosis(program, path is not None, f"{path or 'not installed'} ({why})", do)


def _scheduling() -> Iterator[Diagnosis]:
    if sys.platform != "linux":  # others give it to whoever asks
        return
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        yield Diagnosis("real-time scheduling", True, "SCHED_FIFO allowed")
    except OSError as error:
        do = "allow it: `rtprio 80` for your user in /etc/security/limits.conf, then log in again"
        yield Diagnosis("real-time scheduling", False, f"SCHED_FIFO refused: {error}", do)


def _timer() -> Diagnosis:
    """Measure how late sleeps of 1 ms end."""
    late_us = []
    for _ in range(50):
        begin = time.perf_counter()
        time.sleep(1e-3)
        late_us.append((time.perf_counter() - begin - 1e-3) * 1e6)
    median, fine = sorted(late_us)[25], sorted(late_us)[25] < 300
    do = "" if fine else "use a kernel with high-resolution timers and less other load"
    return Diagnosis("timer", fine, f"1 ms sleeps wake {median:.0f} us late (median)", do)


def _serial_port(device: str, description: str) -> Diagnosis:
    """Look if a port may be opened, and if its adapter delays bytes."""
    from springpot.host.devices.serial_port import latency_timer

    what, seen = f"serial port {device}", description.replace("n/a", "nothing is known of it")
    if sys.platform != "win32" and not os.access(device, os.R_OK | os.W_OK):
        do = "join the port's group (often `sudo usermod -aG dialout $USER`), then log in again"
        return Diagnosis(what, False, f"{seen}: permission denied", do)
    file, ms = latency_timer(device) or (None, 1)
    if ms > 1:
        return Diagnosis(
            what, False, f"{seen}: latency timer {ms} ms", f"`echo 1 | sudo tee {file}`"
        )
    return Diagnosis(what, True, seen)
