"""The C of the loop in this process, and the rows that it writes."""

import re
from collections.abc import Sequence
from enum import IntEnum
from functools import cache
from pathlib import Path

import cffi
import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.entry_points import load_entries
from springpot.codegen.native.c_library import CLibrary, load_c
from springpot.codegen.native.compiler import CompilerError
from springpot.runtime_c.paths import PORT_POSIX, PORT_WIRE, SIM

_ROW = (PORT_POSIX / "sp_loop.h").read_text(encoding="utf-8").partition("} sp_row;")[0]
# Columns of a table of rows: the members of sp_row, in order.
COLUMNS = tuple(re.findall(r"^    double (\w+);", _ROW.rpartition("typedef struct")[2], re.M))
COLUMN = {name: k for k, name in enumerate(COLUMNS)}
INPUT = "input_m"  # of a log: the position as sp_step got it, which may not be finite
IDLE, RESET, NONE, SILENT, UNSENT = 1, 2, 4, 8, 16  # bits of a row's call
GOT_FIFO, GOT_LOCKED, GOT_SLACK, GOT_CPU = 1, 2, 4, 8
LoopRows = Samples  # shape (n, len(COLUMNS))


class Stop(IntEnum):
    """Reason why a loop ended: SP_STOP_ of sp_loop.h."""

    NONE = 0
    ASKED = 1
    TIME = 2
    FORCE = 3
    DEPTH = 4
    ENDED = 5
    MISUSE = 6
    RATE = 7
    BUTTON = 8


@cache
def loop_library(real: str) -> CLibrary:
    """Load the posix port for one number type, with the links of every device that is registered.

    real: "float" or "double". A link is one C file that declares what its driver calls between the
    lines "springpot declarations begin" and "end", as those of sp_link_*.c do. Raises
    CompilerError that names the links of other packages where they cannot be built.
    """
    others = [Path(link) for driver in load_entries("devices", object).values()
              for link in getattr(driver, "links", ())]  # fmt: skip
    try:
        library = _built(real, others)
    except (CompilerError, OSError, cffi.CDefError, cffi.FFIError) as error:  # declared twice
        if not others:
            raise
        packages = ", ".join(map(str, others))
        raise CompilerError(f"{error}: correct or uninstall what brings {packages}") from None
    assert library.ffi.sizeof("sp_row") == 8 * len(COLUMNS)
    assert all(getattr(library.c, f"SP_STOP_{reason.name}") == reason for reason in Stop)
    return library


def _built(real: str, others: Sequence[Path]) -> CLibrary:
    """Build the port with the links of other packages."""
    names = ("sp_link.h", "sp_loop.h", "sp_press.h")
    links = [*sorted(PORT_POSIX.glob("sp_link_*.c")), *others]
    headers = [SIM / "sim.h", *(PORT_POSIX / name for name in names), *links]
    sources = [*sorted(PORT_POSIX.glob("*.c")), *others, PORT_WIRE / "sp_wire.c"]
    return load_c(headers, [*sources, *sorted(SIM.glob("*.c"))], real, ["-pthread"])


def empty_rows(count: int = 0) -> LoopRows:
    """Return a table of `count` rows, zero."""
    return np.zeros((count, len(COLUMNS)))
