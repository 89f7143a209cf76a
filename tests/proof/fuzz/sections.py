"""A text that a fuzzer can change where the file itself is compressed or has checksums.

The fuzzer works on the parts of a file, one after the other; a harness packs them as the project
does, with the right checksums, so that what lies behind these is reached.
"""

_BETWEEN = b"\n--part--\n"


def joined(parts: list[bytes]) -> bytes:
    """What the fuzzer sees of a file of these parts."""
    return _BETWEEN.join(parts)


def split(content: bytes) -> list[bytes]:
    """The parts of what the fuzzer made."""
    return content.split(_BETWEEN)
