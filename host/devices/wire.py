"""springpot serial, Python's end: the table of sp_wire_messages.h, frames out of it, and back."""

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

from cobs import cobs
from google_crc32c import value as crc32c

from springpot.codegen.messages import short_repr
from springpot.codegen.types import JsonObject
from springpot.runtime_c.paths import PORT_WIRE

_CODES = {"u8": "B", "u32": "I", "f32": "f"}
_HEAD = struct.Struct("<BBI")
_CRC = struct.Struct("<I")
_WINDOW = 32


@dataclass(frozen=True)
class Message:
    """One row of the table: its number, and the name and type of each field of its body."""

    name: str
    number: int
    fields: tuple[tuple[str, str], ...]

    @cached_property
    def body(self) -> struct.Struct:
        """Layout of the body."""
        return struct.Struct("<" + "".join(_CODES[kind] for _, kind in self.fields))

    @property
    def wire_bytes(self) -> int:
        """Bytes of one frame on the wire."""
        return _HEAD.size + self.body.size + _CRC.size + 3


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
    text = (PORT_WIRE / "sp_wire_messages.h").read_text()
    text = text[text.index("#define SP_WIRE_TABLE") :]
    found = {}
    for number, upper, name in re.findall(r"MESSAGE\((\d+), (\w+), (\w+)\)", text):
        part = text.split(f"#define SP_WIRE_{upper}(FIELD)")[1].split("\n\n")[0]
        fields = re.findall(r"FIELD\((\w+), (\w+)\)", part)
        found[name] = Message(name, int(number), tuple((field, kind) for kind, field in fields))
    return found


@cache
def constant(name: str) -> int:
    """Return a constant of the header, such as "VERSION" or "TRIPPED"."""
    text = (PORT_WIRE / "sp_wire_messages.h").read_text()
    found = re.search(rf"\bSP_WIRE_{name}(?: = | )(\d+)", text)
    assert found is not None, name
    return int(found.group(1))


@cache
def layout() -> int:
    """Checksum of the table: sp_wire_layout()."""
    rows = (
        f"{message.number} {message.name}:"
        + "".join(f"{kind} {name};" for name, kind in message.fields)
        for message in messages().values()
    )
    return int(crc32c("".join(rows).encode()))


class Sender:
    """Numbers and encodes the frames of one end."""

    def __init__(self) -> None:
        self.sequence = 0

    def encode(self, name: str, **values: Any) -> bytes:
        """Bytes of the next frame, the 0 bytes around it included."""
        message = messages()[name]
        plain = _HEAD.pack(message.number, constant("VERSION"), self.sequence)
        plain += message.body.pack(*(values[field] for field, _ in message.fields))
        self.sequence = (self.sequence + 1) & 0xFFFFFFFF
        return bytes(b"\0" + cobs.encode(plain + _CRC.pack(crc32c(plain))) + b"\0")


class Receiver:
    """Cuts frames out of bytes; counts what was damaged (crc_errors) and what never came (gaps)."""

    def __init__(self) -> None:
        self.frames = self.crc_errors = self.gaps = self.other_versions = 0
        self.other_version = 0
        self._pending = bytearray()
        self._newest = 0
        self._seen = 0
        self._known = {message.number: message for message in messages().values()}

    def feed(self, content: bytes) -> Iterator[Frame]:
        """Yield the whole frames that these bytes complete."""
        self._pending += content
        while (end := self._pending.find(0)) >= 0:
            chunk = bytes(self._pending[:end])
            del self._pending[: end + 1]
            if chunk and (frame := self._frame(chunk)) is not None:
                yield frame

    def restart(self) -> None:
        """Forget the sequence: the other end has started again."""
        self._seen = 0

    def _frame(self, chunk: bytes) -> Frame | None:
        try:
            plain = cobs.decode(chunk)
        except cobs.DecodeError:
            plain = b""
        covered = len(plain) - _CRC.size
        if covered < _HEAD.size or _CRC.pack(crc32c(plain[:covered])) != plain[covered:]:
            self.crc_errors += 1
            return None
        number, version, sequence = _HEAD.unpack_from(plain)
        if version != constant("VERSION"):
            self.other_versions += 1
            self.other_version = version
            return None
        self.frames += 1
        message = self._known.get(number)
        old = self._place(sequence, message is not None and message.name == "hello")
        if message is None or message.body.size != covered - _HEAD.size:
            return None
        body = message.body.unpack_from(plain, _HEAD.size)
        values = {field: value for (field, _), value in zip(message.fields, body, strict=True)}
        return Frame(message.name, sequence, values, old)

    def _place(self, sequence: int, is_hello: bool) -> bool:
        ahead = (sequence - self._newest) & 0xFFFFFFFF
        behind = (self._newest - sequence) & 0xFFFFFFFF
        restarted = is_hello and ahead >= 1 << 31 and behind >= _WINDOW
        if not self._seen or restarted:
            self._seen = 0xFFFFFFFF  # nothing before the first frame of a start is missing
        elif 0 < ahead < 1 << 31:
            self.gaps += ahead - 1
            self._seen = ((self._seen << ahead) | 1) & 0xFFFFFFFF if ahead < _WINDOW else 1
        else:
            if 0 < behind < _WINDOW and not self._seen >> behind & 1:
                self._seen |= 1 << behind
                self.gaps -= 1
            return True
        self._newest = sequence
        return False
