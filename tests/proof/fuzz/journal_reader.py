"""Journals: metadata and blocks of samples, sealed again with the right CRC."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from proof.fuzz.reader import Reader, joined, split

from springpot.trainer.recordings.formats.importing import import_file
from springpot.trainer.recordings.journal_blocks import (
    LAST_METADATA,
    PAYLOAD_BYTES,
    SAMPLES,
    encode,
)
from springpot.trainer.recordings.recording_file import read_recording

_METADATA = {
    "schema": 1, "name": "a", "dt_s": 0.001, "source": "sim://x", "details": {"rate_hz": 1000},
    "block_s": 0.2, "zero": "none",
}  # fmt: skip


def seeds() -> Iterator[tuple[str, bytes]]:
    """Journals with and without channels, with a damaged block, cut short."""
    rows = np.arange(60.0) * 1e-3
    text = json.dumps(_METADATA).encode()
    more = json.dumps(_METADATA | {"channels": ["notes"]}).encode()
    head, samples = bytes([LAST_METADATA]), bytes([SAMPLES]) + rows.tobytes()
    yield "plain", joined([head + text, samples, samples])
    yield "channels", joined([head + more, samples, samples])
    yield "damaged", joined([head + text, samples, b"\xff", samples])
    yield "two of metadata", joined([b"\0" + text[:40], head + text[40:], samples])
    yield "raw", b"raw" + encode(7, 0, LAST_METADATA, text) + encode(7, 1, SAMPLES, rows.tobytes())


def journal_of_parts(content: bytes) -> bytes:
    """Blocks of what the fuzzer made: a kind and its payload each; above 15, a bad block."""
    if content.startswith(b"raw"):
        return content[3:]
    blocks = []
    for k, part in enumerate(split(content)):
        block = encode(7, k, part[0] & 15 if part else 0, part[1:][:PAYLOAD_BYTES])
        blocks.append(block if part and part[0] < 16 else block[:-1] + b"\0")
    return b"".join(blocks)


def read(content: bytes, folder: Path) -> None:
    """Recover it as every command does, and cut it as import does."""
    file = folder / "a.journal"
    file.write_bytes(journal_of_parts(content))
    try:
        read_recording(file)
    finally:
        import_file(file, None, "none", None)


READER = Reader(
    seeds,
    read,
    words=('"schema": ', '"name": ', '"dt_s": ', '"block_s": ', '"details": ', '"channels": [',
           '"zero": ', '"source": ', "null", "1e999", "NaN", "-1", '"min"', "[[", "{}"),
)  # fmt: skip
