"""Arrays in an npz that a stranger may have made: sizes are checked before memory is taken."""

import io
import math
import re
import struct
import zipfile
import zlib
from typing import IO, Any

import numpy as np

from springpot.codegen.errors import DataError
from springpot.codegen.regular_file import max_unpacked_bytes

Arrays = dict[str, np.ndarray[Any, Any]]
MAX_BYTES = 1 << 29  # of a file, and of all its arrays: a forest of 19 million nodes
_MAX_ARRAYS = 256
_MAX_RATIO = 64  # models shrink to a tenth at most
# As numpy writes it, and nothing else: numpy itself evaluates what stands there.
_NPY_START = b"\x93NUMPY\x01\x00"
_NPY_HEADER = re.compile(
    rb"\{'descr': '([<>|][fiub][1248])', 'fortran_order': (True|False), "
    rb"'shape': \(([0-9, ]{0,80})\), \}[ \n]*"
)


def unpacked(body: bytes) -> Arrays:
    """Arrays of an npz by name. Raises DataError, without the file's name, where it is none."""
    try:
        with zipfile.ZipFile(io.BytesIO(body)) as stored:
            entries = stored.infolist()
            _require_sizes(entries, min(MAX_BYTES, max_unpacked_bytes(len(body), _MAX_RATIO)))
            return {entry.filename.removesuffix(".npy"): _array(stored, entry) for entry in entries}
    # The decompressors raise whatever they meet.
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, RuntimeError,
            ValueError, TypeError, MemoryError, struct.error) as error:  # fmt: skip
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise DataError(f"its arrays cannot be read ({reason})") from None


def _require_sizes(entries: list[zipfile.ZipInfo], max_bytes: int) -> None:
    names = {entry.filename for entry in entries}
    if len(names) != len(entries) or len(entries) > _MAX_ARRAYS:
        raise DataError(f"holds {len(entries)} arrays under {len(names)} names")
    declared = sum(entry.file_size for entry in entries)
    if declared > max_bytes:
        raise DataError(f"declares {declared / 2**20:.0f} MiB, more than {max_bytes >> 20}")
    for entry in entries:
        if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise DataError(f"{entry.filename!r} is compressed in a way that numpy never uses")


def _array(stored: zipfile.ZipFile, entry: zipfile.ZipInfo) -> np.ndarray[Any, Any]:
    """One array. Its own header must declare exactly the bytes that the archive holds of it."""
    with stored.open(entry) as file:
        shape, fortran, dtype = _npy_header(file)
        header_bytes = file.tell()
        n_bytes = math.prod(shape) * dtype.itemsize
        if n_bytes != entry.file_size - header_bytes:
            raise DataError(
                f"{entry.filename!r} declares {n_bytes} bytes and holds "
                f"{entry.file_size - header_bytes}"
            )
        content = file.read()
    if len(content) != n_bytes:
        raise DataError(f"{entry.filename!r} ends after {len(content)} of {n_bytes} bytes")
    values = np.frombuffer(content, dtype=dtype)
    return values.reshape(shape, order="F" if fortran else "C")


def _npy_header(file: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    start = file.read(len(_NPY_START) + 2)
    text = file.read(int.from_bytes(start[-2:], "little"))
    found = _NPY_HEADER.fullmatch(text)
    if not start.startswith(_NPY_START) or found is None:
        raise ValueError(f"{text[:80]!r} begins no array of numbers")
    shape = tuple(int(length) for length in found[3].decode().split(",") if length.strip())
    return shape, found[2] == b"True", np.dtype(found[1].decode())
