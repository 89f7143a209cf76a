"""The blocks of a journal: fixed size, each with a checksum, so that damage stays where it is.

A block is 4096 bytes: a header, the payload, zeros, and the CRC-32 of all before it. The first
blocks hold the recording's facts as JSON, the others samples: pairs of position (m) and force (N).
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
_PAIR_BYTES = 16
PAIRS: Final = PAYLOAD_BYTES // _PAIR_BYTES

FACTS, LAST_FACTS, SAMPLES = 0, 1, 2

Pairs = NDArray[np.float64]


@dataclass(frozen=True)
class Block:
    """One block whose checksum is right."""

    journal: int
    index: int
    kind: int
    payload: bytes

    @property
    def pairs(self) -> Pairs:
        """Samples of a block of them, shape (n, 2): position m, force N."""
        return np.frombuffer(self.payload, dtype="<f8").reshape(-1, 2)


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
    if mark != _MARK or used > PAYLOAD_BYTES or (kind == SAMPLES and used % _PAIR_BYTES):
        return None
    return Block(journal, index, kind, body[_HEADER.size : _HEADER.size + used])


def is_journal(start: bytes) -> bool:
    """Tell whether a file that begins with these bytes is a journal."""
    return start.startswith(_MARK)
