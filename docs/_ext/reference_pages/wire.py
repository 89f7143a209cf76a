"""The messages of springpot serial, from the table in sp_wire_messages.h."""

import re
from collections.abc import Iterator

from springpot.host.devices.wire import messages
from springpot.runtime_c.paths import PORT_WIRE

_DEFINED = re.compile(
    r"/\* (?P<about>(?:(?!\*/).)*?) \*/\n#define SP_WIRE_(?P<name>\w+)\(FIELD\)(?P<fields>.*?)\n\n",
    re.S,
)
_FIELD = re.compile(r"FIELD\((?P<kind>\w+), (?P<name>\w+)\)(?P<rest>[^\n]*)")
_ENUM = re.compile(r"^enum \{ (.*?) \};", re.M)


def wire_messages() -> str:
    """Markdown: the head of the header, then for each message its number, bytes and fields."""
    text = (PORT_WIRE / "sp_wire_messages.h").read_text()
    head = text.split("*/")[0].removeprefix("/*")
    about = {found["name"].lower(): found for found in _DEFINED.finditer(text)}
    lines = [line.strip().removeprefix("*").strip() for line in head.splitlines()]
    for name, message in messages().items():
        lines += ["", f"## {name.upper()}, type {message.number}", "", _plain(about[name]["about"])]
        lines += ["", f"At most {message.wire_bytes} bytes on the line.", ""]
        lines += ["| field | type | what |", "| --- | --- | --- |", *_fields(about[name]["fields"])]
    lines += ["", "## Numbers", "", "| name | value |", "| --- | --- |", *_values(text)]
    return "\n".join(lines)


def _values(text: str) -> Iterator[str]:
    for values in _ENUM.findall(text):
        for name, value in (one.split(" = ") for one in values.split(", ")):
            yield f"| `{name}` | {value} |"


def _fields(text: str) -> Iterator[str]:
    for found in _FIELD.finditer(text):
        comment = re.search(r"/\* (.*?) \*/", found["rest"])
        yield f"| `{found['name']}` | `{found['kind']}` | {comment[1] if comment else ''} |"


def _plain(text: str) -> str:
    return " ".join(re.sub(r"^ \* ", "", text, flags=re.M).split())
