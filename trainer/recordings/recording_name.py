"""Names of recordings: they come out of files, and become file names."""

import re
from typing import Any

from springpot.codegen.errors import DataError

MAX_NAME_BYTES = 200  # a file name has 255: room for endings
_UNSAFE = re.compile(r"[^\w.+-]+")


def require_recording_name(name: Any, where: str = "") -> None:
    """Raise DataError where a name could lead out of a folder, or could not be printed.

    where: begins the message, as "FILE: ".
    """
    if not isinstance(name, str):
        raise DataError(f"{where}name={name!r}: a recording's name is text: give a str")
    fits = (
        0 < len(name.encode("utf-8", "replace")) <= MAX_NAME_BYTES
        and name.isprintable()  # neither newlines nor bytes that are no text
        and not name.startswith(".")
        and not set(name) & set("/\\")
    )
    if not fits:
        shown = ascii(name if len(name) <= 60 else f"{name[:57]}...")
        raise DataError(
            f"{where}a recording named {shown}: a name is printable, without / and \\, "
            f"begins with no dot and has 1 to {MAX_NAME_BYTES} bytes: name it otherwise"
        )


def safe_recording_name(text: str) -> str:
    """A name that `require_recording_name` takes, as near to the text as can be."""
    safe = _UNSAFE.sub("_", text).strip("._")
    return safe.encode()[: MAX_NAME_BYTES - 20].decode("utf-8", "ignore") or "recording"
