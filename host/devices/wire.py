"""springpot serial, Python's end: the C of runtime_c/port/wire, by the table of its messages."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from springpot.codegen.messages import short_repr
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.native.compiler import shared_library
from springpot.codegen.types import CData, JsonObject
from springpot.runtime_c.paths import PORT_WIRE

_TYPES = {"u8": ("uint8_t", 1), "u32": ("uint32_t", 4), "f32": ("float", 4)}  # in C, and bytes
_AROUND = 6 + 4 + 3  # bytes of a frame beside its body


@dataclass(frozen=True)
class Message:
    """One row of the table: its number, and the name and type of each field of its body."""

    name: str
    number: int
    fields: tuple[tuple[str, str], ...]

    @property
    def wire_bytes(self) -> int:
        """Bytes of one frame on the wire."""
        return _AROUND + sum(_TYPES[kind][1] for _, kind in self.fields)


@dataclass(frozen=True)
class Frame:
    """A frame that arrived whole. old: repeated, or overtaken by a newer one."""

    name: str
    sequence: int
    values: JsonObject
    old: bool
    __repr__ = short_repr


@cache
def messages() -> dict[str, Message]:
    """Return all messages by name, as the C header has them."""
    text = (PORT_WIRE / "sp_wire_messages.h").read_text(encoding="utf-8")
    text = text[text.index("#define SP_WIRE_TABLE") :]
    table = {}
    for number, upper, name in re.findall(r"MESSAGE\((\d+), (\w+), (\w+)\)", text):
        part = text.split(f"#define SP_WIRE_{upper}(FIELD)")[1].split("\n\n")[0]
        fields = re.findall(r"FIELD\((\w+), (\w+)\)", part)
        table[name] = Message(name, int(number), tuple((field, kind) for kind, field in fields))
    return table


@cache
def _library() -> CLibrary:
    """The C end, built and loaded: its macros make the struct and the calls of each message."""
    header, table = (
        (PORT_WIRE / name).read_text(encoding="utf-8")
        for name in ("sp_wire.h", "sp_wire_messages.h")
    )
    sizes, structs = header.index("enum {"), header.index("typedef struct {\n    uint8_t type;")
    declared = header[sizes : header.index("/* A struct")]
    declared += header[structs : header.index("/* For each message")]
    declared += "".join(re.findall(r"#define SP_WIRE_VERSION .*\n|enum \{.*\};\n", table))
    for name, message in messages().items():
        members = "".join(f"{_TYPES[kind][0]} {field};" for field, kind in message.fields)
        declared += f"typedef struct {{ {members} }} sp_wire_{name};"
        declared += f"uint32_t sp_wire_send_{name}(uint32_t *, const sp_wire_{name} *, uint8_t *);"
        declared += f"int sp_wire_get_{name}(const sp_wire_frame *, sp_wire_{name} *);"
    return CLibrary(shared_library([PORT_WIRE / "sp_wire.c"], [PORT_WIRE]), declared)


def constant(name: str) -> int:
    """Return a constant of the header, such as "VERSION" or "TRIPPED"."""
    return int(getattr(_library().c, f"SP_WIRE_{name}"))


def layout() -> int:
    """Checksum of the table."""
    return int(_library().c.sp_wire_layout())


class Sender:
    """Numbers and encodes the frames of one end."""

    def __init__(self) -> None:
        self.sequence = 0

    def encode(self, name: str, **values: Any) -> bytes:
        """Return bytes of the next frame, the 0 bytes around it included."""
        ffi, c = _library().ffi, _library().c
        sequence = ffi.new("uint32_t *", self.sequence)
        room = ffi.new("uint8_t[]", constant("MAX_BYTES"))
        send = getattr(c, f"sp_wire_send_{name}")
        size = send(sequence, ffi.new(f"sp_wire_{name} *", values), room)
        self.sequence = sequence[0]
        return bytes(ffi.buffer(room, size))


class Receiver:
    """Cuts frames out of bytes. counts: the C receiver, its crc_errors, gaps and other_versions."""

    def __init__(self) -> None:
        new = _library().ffi.new
        self.counts: CData = new("sp_wire_receiver *")
        self._frame = new("sp_wire_frame *")
        self._names = {message.number: name for name, message in messages().items()}

    def feed(self, content: bytes) -> Iterator[Frame]:
        """Yield the whole frames that these bytes complete."""
        new, c, frame = _library().ffi.new, _library().c, self._frame
        for byte in content:
            order = c.sp_wire_receive(self.counts, byte, frame)
            if order != c.SP_WIRE_NONE and (name := self._names.get(frame.type)) is not None:
                body = new(f"sp_wire_{name} *")
                if getattr(c, f"sp_wire_get_{name}")(frame, body):
                    values = {field: getattr(body, field) for field, _ in messages()[name].fields}
                    yield Frame(name, frame.sequence, values, order == c.SP_WIRE_OLD)

    def restart(self) -> None:
        """Forget the sequence: the other end has started again."""
        _library().c.sp_wire_restart(self.counts)
