"""The C of runtime_c/port/posix, built for one number type and loaded."""

import re
from enum import IntEnum
from functools import cache

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.entry_points import registered
from springpot.host.native.c_library import CLibrary, load
from springpot.runtime_c.paths import PORT_POSIX, PORT_WIRE, SIM

_ROW = (PORT_POSIX / "sp_loop.h").read_text(encoding="utf-8").partition("} sp_row;")[0]
# Columns of a table of rows: the members of sp_row, in order.
COLUMNS = tuple(re.findall(r"^    double (\w+);", _ROW.rpartition("typedef struct")[2], re.M))
COLUMN = {name: k for k, name in enumerate(COLUMNS)}
INPUT = "input_m"  # of a log: the position as sp_step got it, which may not be finite
IDLE, RESET, NONE, SILENT, UNSENT = 1, 2, 4, 8, 16  # bits of a row's call
GOT_FIFO, GOT_LOCKED, GOT_SLACK, GOT_CPU = 1, 2, 4, 8


class Stop(IntEnum):
    """Why a loop ended: SP_STOP_ of sp_loop.h."""

    NONE = 0
    ASKED = 1
    TIME = 2
    FORCE = 3
    DEPTH = 4
    ENDED = 5
    MISUSE = 6
    RATE = 7
    BUTTON = 8


LoopRows = NDArray[np.float64]  # shape (n, len(COLUMNS))


@cache
def loop_library(real: str) -> CLibrary:
    """Load the posix port for one number type, with the links of every device that is registered.

    real: "float" or "double". A link is one C file that declares what its driver calls between the
    lines "springpot declarations begin" and "end", as those of sp_link_*.c do.
    """
    names = ("sp_link.h", "sp_loop.h", "sp_press.h", "sp_excite.h", "sp_switch.h")
    drivers = registered("devices", object).values()
    links = [*sorted(PORT_POSIX.glob("sp_link_*.c")),
             *(link for driver in drivers for link in getattr(driver, "links", ()))]  # fmt: skip
    headers = [*(PORT_POSIX / name for name in names), *links]
    sources = [*sorted({*PORT_POSIX.glob("*.c"), *links}), PORT_WIRE / "sp_wire.c"]
    library = load(headers, [*sources, *sorted(SIM.glob("*.c"))], real, ["-pthread"])
    assert library.ffi.sizeof("sp_row") == 8 * len(COLUMNS)
    assert all(getattr(library.c, f"SP_STOP_{reason.name}") == reason for reason in Stop)
    return library


def empty_rows(count: int = 0) -> LoopRows:
    """Return a table of `count` rows, zero."""
    return np.zeros((count, len(COLUMNS)))
