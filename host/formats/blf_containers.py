"""Checks of a BLF log before its reader sees it: sizes that never end, or never fit.

A log is a row of objects with their sizes; some are containers, often compressed, of a stream of
further objects that say their sizes too. The reader of python-can goes on by such a size, be it 0,
and unpacks a container whatever comes out of it.
"""

import struct
import zlib
from pathlib import Path
from typing import BinaryIO

from springpot.codegen.errors import DataError

_FILE_HEADER = struct.Struct("<4sL")  # mark, bytes of the header
_OBJECT = struct.Struct("<4sHHLL")  # mark, bytes of header, its version, bytes of object, type
_CONTAINER = struct.Struct("<H6xL4x")  # compression, bytes inside
_MARK, _CONTAINER_TYPE, _ZLIB = b"LOBJ", 10, 2
_MIN_OBJECT_BYTES = 32  # the headers that every object in a container has
# Frames repeat themselves, but not their times: a log shrinks to a tenth at most.
_MAX_RATIO, _ALWAYS_BYTES = 20, 1 << 20


def require_blf(path: Path) -> None:
    """Raise DataError where a BLF log is no row of objects, or where too much comes out of it."""
    room = max(_ALWAYS_BYTES, _MAX_RATIO * path.stat().st_size)
    tail = b""
    with path.open("rb") as file:
        _, header_bytes = _FILE_HEADER.unpack(file.read(_FILE_HEADER.size).ljust(8, b"\0"))
        file.seek(header_bytes)
        while (content := _container(path, file, room)) is not None:
            room -= len(content)
            tail = _beyond(f"{path}: before byte {file.tell()}", tail + content)


def _container(path: Path, file: BinaryIO, room: int) -> bytes | None:
    """Content of the file's next object, empty if it is no container; None at the end."""
    begin = file.tell()
    head = file.read(_OBJECT.size)
    if len(head) < _OBJECT.size:
        return None
    mark, _, _, size, kind = _OBJECT.unpack(head)
    if mark != _MARK or size < _OBJECT.size:
        raise DataError(
            f"{path}: byte {begin}: begins no object of a BLF log ({size} bytes): copy it again"
        )
    content = file.read(size - _OBJECT.size)
    file.seek(size % 4, 1)
    if kind != _CONTAINER_TYPE or len(content) < _CONTAINER.size:
        return b""
    method, _ = _CONTAINER.unpack_from(content)
    inside = content[_CONTAINER.size :]
    if method == _ZLIB:
        try:
            inside = zlib.decompressobj().decompress(inside, room + 1)
        except zlib.error as error:
            raise DataError(f"{path}: byte {begin}: damaged ({error}): copy it again") from None
    if len(inside) > room:
        raise DataError(
            f"{path}: byte {begin}: more than {_MAX_RATIO} times its size comes out of it, as of "
            "no log: copy it again"
        )
    return inside


def _beyond(where: str, stream: bytes) -> bytes:
    """Walk over the objects of a stream; return the one that goes on in the next container."""
    place = 0
    while (at := stream.find(_MARK, place, place + 8)) >= 0 and len(stream) - at >= _OBJECT.size:
        size = _OBJECT.unpack_from(stream, at)[3]
        if size < _MIN_OBJECT_BYTES:
            raise DataError(f"{where}: an object of {size} bytes: damaged, copy it again")
        if at + size > len(stream):
            return stream[at:]
        place = at + size
    return stream[place:]
