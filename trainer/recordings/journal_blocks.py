"""The blocks of a journal: fixed size, each with a checksum, so that damage stays where it is.

A block is 4096 bytes: a header, the payload, zeros, and the CRC-32 of all before it. The first
blocks hold the recording's metadata as JSON, the others samples: rows of position (m), force (N)
and whatever channels the metadata names beside them.
"""

import struct
import zlib
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

BLOCK_BYTES: Final = 4096
# Mark, number of the journal, number of the block, kind, bytes of payload.
_HEADER = struct.Struct("<8sQIHH")
_CHECKSUM = struct.Struct("<I")
_MARK = b"spjourn1"
PAYLOAD_BYTES: Final = BLOCK_BYTES - _HEADER.size - _CHECKSUM.size
_NUMBER_BYTES = 8
PAIRS: Final = PAYLOAD_BYTES // (2 * _NUMBER_BYTES)

METADATA, LAST_METADATA, SAMPLES = 0, 1, 2

JournalRows = NDArray[np.float64]


def max_rows(width: int) -> int:
    """Rows of `width` numbers that fit into a block."""
    return PAYLOAD_BYTES // (width * _NUMBER_BYTES)


@dataclass(frozen=True)
class Block:
    """One block with a right checksum."""

    journal: int
    index: int
    kind: int
    payload: bytes

    def rows(self, width: int) -> JournalRows:
        """Samples of a block of them, shape (n, width): position m, force N, more channels."""
        return np.frombuffer(self.payload, dtype="<f8").reshape(-1, width)


def encode(journal: int, index: int, kind: int, payload: bytes) -> bytes:
    """Bytes of one block. The payload is at most PAYLOAD_BYTES long."""
    assert len(payload) <= PAYLOAD_BYTES
    body = _HEADER.pack(_MARK, journal, index, kind, len(payload)) + payload
    body = body.ljust(BLOCK_BYTES - _CHECKSUM.size, b"\0")
    return body + _CHECKSUM.pack(zlib.crc32(body))


def decode(content: bytes) -> Block | None:
    """Return the block, or None where these bytes are not one that was written whole."""
    if len(content) != BLOCK_BYTES:
        return None
    body, checksum = content[: -_CHECKSUM.size], content[-_CHECKSUM.size :]
    if _CHECKSUM.pack(zlib.crc32(body)) != checksum:
        return None
    mark, journal, index, kind, used = _HEADER.unpack_from(body)
    if mark != _MARK or used > PAYLOAD_BYTES or (kind == SAMPLES and used % _NUMBER_BYTES):
        return None
    return Block(journal, index, kind, body[_HEADER.size : _HEADER.size + used])


def is_journal(start: bytes) -> bool:
    """Return whether a file that begins with these bytes is a journal."""
    return start.startswith(_MARK)
