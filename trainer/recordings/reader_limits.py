"""Limits of a process that reads a stranger's file: its size says how much it may take.

The HDF5 library and scipy's MAT reader can crash, hang or ask for any memory on damaged files.
"""

import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.codegen.regular_file import max_unpacked_bytes

MAX_RATIO = 256  # a recording of nothing but zeros shrinks by 230
_MAX_BYTES, _LEAST_BYTES = 8 << 30, 1 << 30  # of a process, libraries included
_MAX_CPU_S, _LEAST_CPU_S = 120, 4
_TIMEOUT_S = 150.0
_TOLD = 3  # exit status of a process that read the file, and refuses it in a line of its own


def limit_reader(path: Path) -> None:
    """Limit this process to what reading the file may take."""
    mib = path.stat().st_size >> 20
    max_bytes = min(_MAX_BYTES, _LEAST_BYTES + (mib << 28))
    cpu_s = min(_MAX_CPU_S, _LEAST_CPU_S + mib)
    resource.setrlimit(resource.RLIMIT_AS, (max_bytes, max_bytes))
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s))


def require_unpacked(path: Path, unpacked_bytes: int, what: str) -> None:
    """Raise ValueError if more comes out of a file than one of its size can hold.

    what: comes out of it, such as "MiB of numbers".
    """
    file_bytes = path.stat().st_size
    if unpacked_bytes > max_unpacked_bytes(file_bytes, MAX_RATIO):
        raise ValueError(f"{unpacked_bytes >> 20} {what} in {file_bytes} bytes")


def run_reader(path: Path, read: Callable[[Path], bytes]) -> None:
    """Print what `read` makes of the file, within its limits; or end this process with one line."""
    limit_reader(path)
    try:
        sys.stdout.buffer.write(read(path))
    except DataError as error:
        print(error, file=sys.stderr)
        sys.exit(_TOLD)
    except Exception as error:  # whatever the libraries raise on a damaged file
        sys.exit(" ".join(f"{type(error).__name__}: {error}".split())[:200])


def read_apart(path: Path, module: str, *arguments: str) -> bytes:
    """Run `module` on the file; return its output. Raises DataError if it refuses, or is ended."""
    command = [sys.executable, "-m", module, str(path), *arguments]
    # Each thread of a numerical library would count as memory taken.
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    try:
        result = subprocess.run(
            command, capture_output=True, check=False, timeout=_TIMEOUT_S, env=environment
        )
    except subprocess.TimeoutExpired:
        raise DataError(f"{path}: reading it does not end: damaged, export it again") from None
    lines = result.stderr.decode(errors="replace").strip().splitlines()
    if result.returncode == _TOLD and lines:
        raise DataError(lines[-1])
    if result.returncode:
        why = lines[-1] if lines and result.returncode > 0 else "it crashes the reader"
        raise DataError(f"{path}: damaged or of another format ({why}): export it again")
    return result.stdout
