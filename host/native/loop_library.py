"""The C of runtime_c/port/posix, built for one number type and loaded."""

from enum import IntEnum
from functools import cache
from typing import Any

import cffi
import numpy as np
from numpy.typing import NDArray

from springpot.host.native.compiler import shared_library
from springpot.runtime_c.paths import INCLUDE, PORT_POSIX, PORT_WIRE, SIM

_BEGIN, _END = "/* springpot declarations begin */", "/* springpot declarations end */"
# Columns of a table of rows: the members of sp_row, in order.
COLUMNS = (
    "time_s",
    "position_m",
    "velocity_mps",
    "dt_s",
    "returned_n",
    "sent_n",
    "measured_n",
    "notes",
    "call",
    "age_s",
    "lateness_s",
    "tick_s",
)
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


Rows = NDArray[np.float64]  # shape (n, len(COLUMNS))


class LoopLibrary:
    """Functions and types of sp_link.h, sp_loop.h and sp_press.h for one number type."""

    def __init__(self, real: str) -> None:
        self.ffi = cffi.FFI()
        self.ffi.cdef(f"typedef {real} sp_real;")
        for name in ("sp_link.h", "sp_loop.h", "sp_press.h"):
            text = (PORT_POSIX / name).read_text()
            self.ffi.cdef(text[text.index(_BEGIN) : text.index(_END)])
        sources = [*sorted(PORT_POSIX.glob("*.c")), PORT_WIRE / "sp_wire.c"]
        sources += sorted(SIM.glob("*.c"))
        include = [INCLUDE / real, PORT_POSIX, PORT_WIRE, SIM]
        self.c = self.ffi.dlopen(str(shared_library(sources, include, ["-pthread"])))
        assert self.ffi.sizeof("sp_row") == 8 * len(COLUMNS)
        assert all(getattr(self.c, f"SP_STOP_{reason.name}") == reason for reason in Stop)

    def memory(self, size: int) -> Any:
        """`size` bytes of C memory, zero, aligned as for double; lives as long as the object."""
        return self.ffi.new("double[]", -(-size // 8))

    def rows(self, table: Rows) -> Any:
        """A C pointer to the memory of a table of rows."""
        return self.ffi.from_buffer("sp_row[]", table)


@cache
def loop_library(real: str) -> LoopLibrary:
    """Build and load it once; real: "float" or "double"."""
    return LoopLibrary(real)


def empty_rows(count: int = 0) -> Rows:
    """Return a table of `count` rows, zero."""
    return np.zeros((count, len(COLUMNS)))
