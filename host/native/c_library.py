"""C in this process: built through the cache, loaded, given memory; and the loop's."""

import re
from collections.abc import Sequence
from enum import IntEnum
from functools import cache
from pathlib import Path

import cffi
import numpy as np

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.entry_points import load_entries
from springpot.codegen.types import CData
from springpot.host.native.compiler import CompilerError, shared_library
from springpot.runtime_c.paths import INCLUDE, PORT_POSIX, PORT_WIRE, SIM

_BEGIN, _END = "/* springpot declarations begin */", "/* springpot declarations end */"
_ALIGNMENT = 8  # of every state of ours: as for double
# C types of arrays, by the letter of numpy's type.
_ARRAYS = {"f4": "float[]", "f8": "double[]", "i4": "int32_t[]", "u1": "uint8_t[]"}
_ROW = (PORT_POSIX / "sp_loop.h").read_text(encoding="utf-8").partition("} sp_row;")[0]
# Columns of a table of rows: the members of sp_row, in order.
COLUMNS = tuple(re.findall(r"^    double (\w+);", _ROW.rpartition("typedef struct")[2], re.M))
COLUMN = {name: k for k, name in enumerate(COLUMNS)}
INPUT = "input_m"  # of a log: the position as sp_step got it, which may not be finite
IDLE, RESET, NONE, SILENT, UNSENT = 1, 2, 4, 8, 16  # bits of a row's call
GOT_FIFO, GOT_LOCKED, GOT_SLACK, GOT_CPU = 1, 2, 4, 8
LoopRows = Samples  # shape (n, len(COLUMNS))


class CLibrary:
    """A shared library with what its headers declare. ffi: cffi's types. c: functions, constants.

    Pointers that `memory` and `array` return own their memory or keep its owner: C may use it for
    as long as they live. An address keeps nothing.
    """

    def __init__(self, path: Path, declarations: str) -> None:
        """Load it. Raises CompilerError if the library was built for another machine."""
        self.ffi = cffi.FFI()
        self.ffi.cdef(declarations)
        try:
            self.c: CData = self.ffi.dlopen(str(path))
        except OSError as error:
            raise CompilerError(
                f"{path}: cannot be loaded here ({error}): remove it, check CC"
            ) from None

    def memory(self, size: int, kind: str = "double") -> CData:
        """A pointer to `size` bytes for a C state of type `kind`, zero, aligned as for double."""
        values = np.zeros(-(-size // _ALIGNMENT))
        return self.ffi.from_buffer(f"{kind} *", values, require_writable=True)

    def array(self, values: Reals) -> CData:
        """Return a pointer to the numbers of a contiguous array, in its own type."""
        return self.ffi.from_buffer(_ARRAYS[values.dtype.str[1:]], values)

    def address(self, pointer: CData) -> int:
        """Address of a function or a state, for C that was loaded as another library."""
        return int(self.ffi.cast("uintptr_t", pointer))

    def pointer(self, address: int) -> CData:
        """Return a void pointer to what another library has at that address."""
        return self.ffi.cast("void *", address)


def declarations(headers: Sequence[Path], real: str = "") -> str:
    """Cut what cffi reads out of headers; real: "float" or "double" where they use sp_real.

    Raises CompilerError for a header that begins declarations and does not end them.
    """
    parts = [f"typedef {real} sp_real;"] if real else []
    for header in headers:
        text = header.read_text(encoding="utf-8")
        for declared in text.split(_BEGIN)[1:]:
            if _END not in declared:
                raise CompilerError(f"{header}: has no line {_END!r} after {_BEGIN!r}")
            parts.append(declared[: declared.index(_END)])
    return "\n".join(parts)


def load_c(
    headers: Sequence[Path],
    sources: Sequence[Path],
    real: str = "",
    extra_flags: Sequence[str] = (),
) -> CLibrary:
    """Build C of ours, unless that was done before, and load it; real: as for `declarations`.

    Headers are looked for where `headers` and `sources` lie.
    """
    include = sorted({file.parent for file in (*headers, *sources)})
    include += [INCLUDE, INCLUDE / real] if real else []
    path = shared_library(sources, include, extra_flags)
    return CLibrary(path, declarations(headers, real))


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
