"""What this machine offers: found or not, why it matters, and what to do."""

import os
import resource
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass

from serial.tools import list_ports

from springpot.console import part
from springpot.devices import latency_timer
from springpot.native import (
    CompilerError,
    cache_folder,
    compiler_reason,
    compiler_version,
    find_compiler,
)

_LATENCY_MS = 1


@dataclass(frozen=True)
class Diagnosis:
    """One row: what was looked for, whether it is fine, what was seen, and what to do if not."""

    what: str
    found: bool
    seen: str
    do: str = ""


def examine() -> list[Diagnosis]:
    """Look at everything that springpot uses on this machine."""
    checks: tuple[Callable[[], Diagnosis], ...] = (_compiler, _cache, _scheduling, _locked, _timer)
    findings = [check() for check in checks]
    findings += [*_serial_ports(), *_force_dimension()]
    for program, package, why in (
        ("arm-none-eabi-gcc", "gcc-arm-none-eabi", "C for Cortex-M boards"),
        ("riscv64-unknown-elf-gcc", "gcc-riscv64-unknown-elf", "C for RISC-V boards"),
        ("node", "nodejs", "WebAssembly's self-test"),
        ("qemu-system-arm", "qemu-system-arm", "boards without hardware"),
        ("qemu-system-riscv32", "qemu-system-misc", "boards without hardware"),
    ):
        findings.append(_program(program, package, why))
    return findings


def _compiler() -> Diagnosis:
    try:
        compiler = find_compiler()
    except CompilerError as error:
        return Diagnosis("C compiler", False, "none", str(error))
    seen = f"{' '.join(compiler)}: {compiler_version(compiler)} ({compiler_reason()})"
    return Diagnosis("C compiler", True, seen)


def _cache() -> Diagnosis:
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".probe"
        probe.touch()
        probe.unlink()
    except OSError as error:
        do = "set XDG_CACHE_HOME to a folder that you can write"
        return Diagnosis("library cache", False, f"{folder}: {error.strerror}", do)
    libraries = list(folder.glob("*.so"))
    size = sum(library.stat().st_size for library in libraries)
    return Diagnosis(
        "library cache", True, f"{folder}: {len(libraries)} built, {size / 1e6:.1f} MB"
    )


def _scheduling() -> Diagnosis:
    what = "real-time scheduling"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    except (OSError, AttributeError) as error:
        do = "allow it: `rtprio 80` for your user in /etc/security/limits.conf, then log in again"
        return Diagnosis(what, False, f"SCHED_FIFO refused: {error}", do)
    return Diagnosis(what, True, "SCHED_FIFO allowed")


def _locked() -> Diagnosis:
    soft, _ = resource.getrlimit(resource.RLIMIT_MEMLOCK)
    enough = soft == resource.RLIM_INFINITY or soft >= 64 << 20
    if os.geteuid() == 0:
        enough = True
    seen = "no limit" if soft == resource.RLIM_INFINITY else f"{soft >> 10} KiB"
    do = "" if enough else "raise it: `memlock unlimited` in /etc/security/limits.conf"
    return Diagnosis("locked memory", enough, seen, do)


def _timer() -> Diagnosis:
    late_us = []
    for _ in range(50):
        begin = time.perf_counter()
        time.sleep(1e-3)
        late_us.append((time.perf_counter() - begin - 1e-3) * 1e6)
    median = sorted(late_us)[len(late_us) // 2]
    fine = median < 300
    do = "" if fine else "use a kernel with high-resolution timers and less other load"
    return Diagnosis("timer", fine, f"1 ms sleeps wake {median:.0f} us late (median)", do)


def _serial_ports() -> list[Diagnosis]:
    ports = list(list_ports.comports())
    if not ports:
        do = "plug the device in; in a container, pass the device through"
        return [Diagnosis("serial ports", False, "none", do)]
    return [_serial_port(port.device, _words(port.description)) for port in ports]


def _words(description: str) -> str:
    """What the system says of a port: pyserial has n/a where it says nothing, as of most ttyS."""
    return "there, the system does not say what it is" if description == "n/a" else description


def _serial_port(device: str, description: str) -> Diagnosis:
    what = f"serial port {device}"
    if not os.access(device, os.R_OK | os.W_OK):
        do = "join the port's group (often `sudo usermod -aG dialout $USER`), then log in again"
        return Diagnosis(what, False, f"{description}: permission denied", do)
    found = latency_timer(device)
    if found is not None and (ms := found[1]) > _LATENCY_MS:
        do = f"`echo {_LATENCY_MS} | sudo tee {found[0]}`: {ms} ms: {1000 // ms} exchanges a second"
        return Diagnosis(what, False, f"{description}: latency timer {ms} ms", do)
    return Diagnosis(what, True, description)


def _force_dimension() -> list[Diagnosis]:
    sdk_found = part("force-dimension")
    return [] if sdk_found is None else [Diagnosis("Force Dimension's SDK", *sdk_found())]


def _program(program: str, package: str, why: str) -> Diagnosis:
    path = shutil.which(program)
    if path is None:
        return Diagnosis(program, False, f"not installed ({why})", f"`apt-get install {package}`")
    return Diagnosis(program, True, f"{path} ({why})")
