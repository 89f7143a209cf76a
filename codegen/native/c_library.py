"""C in this process: built through the cache, loaded, given memory."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from weakref import WeakKeyDictionary

import cffi
import numpy as np
from numpy.typing import NDArray

from springpot.codegen.native.compiler import CompilerError, shared_library
from springpot.codegen.types import CData
from springpot.runtime_c.paths import INCLUDE

_BEGIN, _END = "/* springpot declarations begin */", "/* springpot declarations end */"
_ALIGNMENT = 8  # of every state of ours: as for double
# C types of arrays, by the letter of numpy's type.
_ARRAYS = {"f4": "float[]", "f8": "double[]", "i4": "int32_t[]", "u1": "uint8_t[]"}
Array = NDArray[np.generic]


class CLibrary:
    """A shared library with what its headers declare. ffi: cffi's types. c: functions, constants.

    Pointers that `memory` and `array` return own their memory or keep its owner: C may use it for
    as long as they live. An address keeps nothing.
    """

    def __init__(self, path: Path, declarations: str) -> None:
        """Load it. Raises CompilerError if the library was built for another machine."""
        self.ffi = cffi.FFI()
        self._kept: WeakKeyDictionary[CData, object] = WeakKeyDictionary()
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

    def array(self, values: Array) -> CData:
        """A pointer to the numbers of a contiguous array, in its own type."""
        return self.ffi.from_buffer(_ARRAYS[values.dtype.str[1:]], values)

    def struct(self, kind: str, values: Mapping[str, Array | float]) -> CData:
        """Allocate a C struct from numbers and arrays; arrays are kept, and shared if possible."""
        members = {
            name: self.array(np.ascontiguousarray(value))
            if isinstance(value, np.ndarray)
            else value
            for name, value in values.items()
        }
        pointer = self.ffi.new(f"{kind} *", members)
        self._kept[pointer] = members
        return pointer

    def address(self, pointer: CData) -> int:
        """Address of a function or a state, for C that was loaded as another library."""
        return int(self.ffi.cast("uintptr_t", pointer))

    def pointer(self, address: int) -> CData:
        """A void pointer to what another library has at that address."""
        return self.ffi.cast("void *", address)


def declarations(headers: Sequence[Path], real: str = "") -> str:
    """Return the declarations for cffi that headers mark; real: the type of sp_real there.

    real: "float" or "double". Raises CompilerError for a header that begins declarations and does
    not end them.
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
    folders: Sequence[Path] = (),
) -> CLibrary:
    """Build C of ours, unless that was done before, and load it; real: as for `declarations`.

    Headers are looked for where `headers` and `sources` lie, and in `folders`.
    """
    include = sorted({file.parent for file in (*headers, *sources)}) + list(folders)
    include += [INCLUDE, INCLUDE / real] if real else []
    path = shared_library(sources, include, extra_flags)
    return CLibrary(path, declarations(headers, real))
