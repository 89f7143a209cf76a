"""Metadata of the machine that a figure was measured on."""

import os
import platform
from importlib.metadata import version
from pathlib import Path

from springpot.host.native.compiler import CompilerError, compiler_version, find_compiler
from springpot.runtime_c.paths import flags


def machine_metadata() -> dict[str, str]:
    """Processor, system, compiler, flags, versions: name -> text."""
    try:
        compiler = compiler_version(find_compiler())
    except CompilerError:
        compiler = "none"
    return {
        "processor": f"{_processor()}, {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "compiler": compiler,
        "flags": " ".join(flags("SP_CFLAGS")),
        "Python": platform.python_version(),
        "springpot": version("springpot"),
        "numpy": version("numpy"),
    }


def cpu_s() -> float:
    """Processor time of this process and of the programs it has waited for, s."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
