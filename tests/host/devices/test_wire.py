"""springpot serial: C and Python agree on every message, and damage is never taken for a value."""

import os
import shutil
import struct
import subprocess

import numpy as np
import pytest

from springpot.host.devices.wire import Receiver, Sender, constant, layout, messages
from springpot.host.native.c_library import CLibrary
from springpot.host.native.compiler import find_compiler, run_compiler, shared_library
from springpot.runtime_c.paths import PORT_WIRE, flags

FRAMES = int(os.environ.get("SPRINGPOT_FRAMES", "10000"))
EXAMPLES = {"u8": [0, 7, 255], "u32": [0, 1 << 31, 0xFFFFFFFF], "f32": [0.0, -1.5, 1e-38]}


@pytest.fixture(scope="module")
def c_end():
    """The C end as a library: encode, receive, and every message's send and get."""
    types = {"u8": "uint8_t", "u32": "uint32_t", "f32": "float"}
    text = """typedef struct { uint8_t type, version; uint32_t sequence, size; uint8_t body[48]; }
        sp_wire_frame;
    typedef struct { uint8_t bytes[61]; uint32_t used, overlong, joining, newest, seen, frames,
        crc_errors, gaps, other_versions; uint8_t other_version; } sp_wire_receiver;
    uint32_t sp_wire_crc32c(const uint8_t *, uint32_t);
    uint32_t sp_wire_layout(void);
    int sp_wire_receive(sp_wire_receiver *, uint8_t, sp_wire_frame *);
    uint32_t sp_wire_encode(const sp_wire_frame *, uint8_t *);
    void sp_wire_restart(sp_wire_receiver *);
    """
    for name, message in messages().items():
        members = "".join(f"{types[kind]} {field};" for field, kind in message.fields)
        text += f"typedef struct {{ {members} }} sp_wire_{name};"
        text += f"uint32_t sp_wire_send_{name}(uint32_t *, const sp_wire_{name} *, uint8_t *);"
        text += f"int sp_wire_get_{name}(const sp_wire_frame *, sp_wire_{name} *);"
    loaded = CLibrary(shared_library([PORT_WIRE / "sp_wire.c"], [PORT_WIRE]), text)
    return loaded.ffi, loaded.c


def test_one_table_for_both_ends(c_end):
    _, lib = c_end
    assert lib.sp_wire_layout() == layout()
    assert lib.sp_wire_crc32c(b"123456789", 9) == 0xE3069283 and len(messages()) == 6


@pytest.mark.parametrize("name", list(messages()))
def test_each_message_both_ways(c_end, name):
    ffi, lib = c_end
    message = messages()[name]
    sender, receiver = Sender(), Receiver()
    sequence, room = ffi.new("uint32_t *"), ffi.new("uint8_t[61]")
    state, frame = ffi.new("sp_wire_receiver *"), ffi.new("sp_wire_frame *")
    for k in range(3):
        values = {field: EXAMPLES[kind][k] for field, kind in message.fields}
        given = ffi.new(f"sp_wire_{name} *")
        for field, _ in message.fields:
            setattr(given, field, values[field])
        count = getattr(lib, f"sp_wire_send_{name}")(sequence, given, room)
        by_c, by_python = bytes(room[0:count]), sender.encode(name, **values)
        assert by_c == by_python and len(by_c) == message.wire_bytes
        (read,) = receiver.feed(by_c)
        assert (read.name, read.sequence, read.old) == (name, k, False)
        body = message.body
        assert body.pack(*read.values.values()) == body.pack(*values.values())
        kinds = [lib.sp_wire_receive(state, byte, frame) for byte in by_python]
        assert kinds == [0] * (count - 1) + [1]
        taken = ffi.new(f"sp_wire_{name} *")
        assert getattr(lib, f"sp_wire_get_{name}")(frame, taken) == 1
        for field, _ in message.fields:
            got = getattr(taken, field)
            assert body.pack(*[got if f == field else values[f] for f, _ in message.fields]) == (
                body.pack(*values.values())
            )


def test_both_ends_count_alike(c_end):
    """The same damaged stream: the same frames, gaps and errors, no wrong value, at both ends.

    And a frame that is whole always comes through, whatever came before it.
    """
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
    found, receiver = heard(c_end, bytes(stream))
    assert whole <= {sequence for sequence, _, _ in found}
    assert all(body == struct.pack("<f", float(sequence)) for sequence, _, body in found)
    assert receiver.crc_errors > 100 and receiver.gaps > 100


def heard(c_end, content: bytes) -> tuple[list[tuple[int, bool, bytes]], Receiver]:
    """Sequence, age and body of each frame, and the receiver: the same at both ends."""
    ffi, lib = c_end
    state, frame, receiver = ffi.new("sp_wire_receiver *"), ffi.new("sp_wire_frame *"), Receiver()
    by_c = []
    for byte in content:
        if kind := lib.sp_wire_receive(state, byte, frame):
            by_c.append((frame.sequence, kind == 2, bytes(frame.body[0 : frame.size])))
    assert by_c == [
        (one.sequence, one.old, messages()[one.name].body.pack(*one.values.values()))
        for one in receiver.feed(content)
    ]
    for count in ("frames", "gaps", "crc_errors"):
        assert getattr(state, count) == getattr(receiver, count)
    return by_c, receiver


def both_ends(c_end, content: bytes) -> tuple[list[tuple[int, bool]], int]:
    """Sequence and age of each frame, and how many are missing."""
    found, receiver = heard(c_end, content)
    return [frame[:2] for frame in found], receiver.gaps


def numbered(sequence: int, name: str = "ack", **values: object) -> bytes:
    sender = Sender()
    sender.sequence = sequence
    return sender.encode(name, **(values or {"command": 0, "refused": 0}))


def test_nothing_before_the_first_frame_is_missing(c_end):
    content = b"".join(map(numbered, (5, 4, 6, 3, 8)))
    told = [(5, False), (4, True), (6, False), (3, True), (8, False)]
    assert both_ends(c_end, content) == (told, 1)


def test_a_device_that_starts_again_is_heard_from_its_hello_on(c_end):
    hello = {"layout": 0, "rate_hz": 1.0, "max_n": 1.0}
    content = numbered(100_000) + numbered(0, "hello", **hello) + numbered(1) + numbered(2)
    told, gaps = both_ends(c_end, content)
    assert told == [(100_000, False), (0, False), (1, False), (2, False)] and gaps == 0
    # one that was only overtaken starts nothing
    content = numbered(100) + numbered(99, "hello", **hello) + numbered(98) + numbered(101)
    assert [old for _, old in both_ends(c_end, content)[0]] == [False, True, True, False]


def test_another_version_is_told_not_read(c_end):
    ffi, lib = c_end
    frame = ffi.new("sp_wire_frame *", {"type": 6, "version": 9, "sequence": 3, "size": 4})
    room = ffi.new("uint8_t[61]")
    content = bytes(room[0 : lib.sp_wire_encode(frame, room)])
    receiver = Receiver()
    assert list(receiver.feed(content)) == []
    assert (receiver.other_versions, receiver.other_version) == (1, 9)
    state = ffi.new("sp_wire_receiver *")
    assert [lib.sp_wire_receive(state, byte, frame) for byte in content] == [0] * len(content)
    assert (state.other_versions, state.other_version) == (1, 9) and constant("VERSION") == 2


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
