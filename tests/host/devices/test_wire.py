"""springpot serial: every message byte for byte, and damage is never taken for a value."""

import os
import shutil
import struct
import subprocess

import numpy as np
import pytest
from cobs import cobs
from google_crc32c import value as crc32c

from springpot.codegen.native.compiler import find_compiler, run_compiler
from springpot.host.devices.wire import Receiver, Sender, constant, layout, messages
from springpot.runtime_c.paths import PORT_WIRE, flags

FRAMES = int(os.environ.get("SPRINGPOT_FRAMES", "10000"))
EXAMPLES = {"u8": [0, 7, 255], "u32": [0, 1 << 31, 0xFFFFFFFF], "f32": [0.0, -1.5, 1e-38]}
CODES = {"u8": "B", "u32": "I", "f32": "f"}


def body_of(name: str) -> struct.Struct:
    return struct.Struct("<" + "".join(CODES[kind] for _, kind in messages()[name].fields))


def framed(number: int, sequence: int, body: bytes, version: int = 2) -> bytes:
    """As sp_wire_messages.h describes a frame, by other packages."""
    plain = struct.pack("<BBI", number, version, sequence) + body
    return b"\0" + cobs.encode(plain + crc32c(plain).to_bytes(4, "little")) + b"\0"


def test_the_table_has_a_checksum() -> None:
    rows = "".join(f"{one.number} {name}:" + "".join(f"{kind} {of};" for of, kind in one.fields)
                   for name, one in messages().items())  # fmt: skip
    assert crc32c(rows.encode()) == layout() and len(messages()) == 6


@pytest.mark.parametrize("name", list(messages()))
def test_each_message_both_ways(name: str) -> None:
    message, sender, receiver = messages()[name], Sender(), Receiver()
    for k in range(3):
        values = {field: EXAMPLES[kind][k] for field, kind in message.fields}
        body = body_of(name).pack(*values.values())
        content = sender.encode(name, **values)
        assert content == framed(message.number, k, body) and len(content) == message.wire_bytes
        (read,) = receiver.feed(content)
        assert (read.name, read.sequence, read.old) == (name, k, False)
        assert body_of(name).pack(*read.values.values()) == body


def test_damage_is_counted_and_gives_no_wrong_value() -> None:
    """And a frame that is whole always comes through, whatever came before it."""
    rng, sender = np.random.default_rng(5), Sender()
    frames = [sender.encode("force", force_n=float(k)) for k in range(FRAMES)]
    stream, whole = bytearray(), set()
    for k in range(FRAMES):
        content = bytearray(frames[k])
        match int(rng.integers(0, 12)):
            case 0:
                content[rng.integers(0, len(content))] ^= 1 << int(rng.integers(0, 8))
            case 1:
                content = content[: rng.integers(0, len(content))]
            case 2:
                content = content + content
            case 3 if k > 40:
                content += frames[k - int(rng.integers(1, 40))]
            case 4:
                content += bytes(rng.integers(0, 256, rng.integers(1, 90), dtype=np.uint8))
        stream += content
        if content.startswith(frames[k]):
            whole.add(k)
    receiver = Receiver()
    found = list(receiver.feed(bytes(stream)))
    assert whole <= {frame.sequence for frame in found}
    assert all(frame.values == {"force_n": float(frame.sequence)} for frame in found)
    came = {frame.sequence for frame in found}
    missing = max(came) + 1 - min(came) - len(came)
    assert receiver.counts.crc_errors > 100 and receiver.counts.gaps >= missing > 100


def heard(*content: bytes) -> tuple[list[tuple[int, bool]], int]:
    """Sequence and age of each frame, and how many are missing."""
    receiver = Receiver()
    found = [(frame.sequence, frame.old) for frame in receiver.feed(b"".join(content))]
    return found, receiver.counts.gaps


def numbered(sequence: int, name: str = "ack", **values: object) -> bytes:
    sender = Sender()
    sender.sequence = sequence
    return sender.encode(name, **(values or {"command": 0, "refused": 0}))


def test_nothing_before_the_first_frame_is_missing() -> None:
    told = [(5, False), (4, True), (6, False), (3, True), (8, False)]
    assert heard(*map(numbered, (5, 4, 6, 3, 8))) == (told, 1)


def test_a_device_that_starts_again_is_heard_from_its_hello_on() -> None:
    hello = {"layout": 0, "rate_hz": 1.0, "max_n": 1.0}
    told, gaps = heard(numbered(100_000), numbered(0, "hello", **hello), numbered(1), numbered(2))
    assert told == [(100_000, False), (0, False), (1, False), (2, False)] and gaps == 0
    # one that was only overtaken starts nothing
    content = numbered(100), numbered(99, "hello", **hello), numbered(98), numbered(101)
    assert [old for _, old in heard(*content)[0]] == [False, True, True, False]


def test_another_version_is_told_not_read() -> None:
    receiver = Receiver()
    assert list(receiver.feed(framed(6, 3, bytes(4), version=9))) == []
    counts = receiver.counts
    assert (counts.other_versions, counts.other_version) == (1, 9) and constant("VERSION") == 2


@pytest.mark.skipif(shutil.which("nm") is None, reason="no nm")
@pytest.mark.parametrize("level", ["-O0", "-Os", "-O2"])
def test_the_c_end_needs_nothing(tmp_path, level):
    """A microcontroller without libc links it: no undefined symbol, no data that changes."""
    built = tmp_path / "wire.o"
    options = [*flags("SP_STRICT"), "-std=c11", level, "-ffreestanding", "-c"]
    run_compiler([*options, str(PORT_WIRE / "sp_wire.c"), "-o", str(built)])
    symbols = subprocess.run(["nm", built], capture_output=True, text=True, check=True).stdout
    kinds = {line.split()[-2] for line in symbols.splitlines()}
    assert kinds <= {"T", "t", "r", "R"}, (find_compiler(), symbols)
