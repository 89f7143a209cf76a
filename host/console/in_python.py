"""Messages in Python: options of the command line as the arguments that do the same."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

from springpot.codegen.errors import SpringpotError

# The options that are not the argument with the same name.
_ARGUMENTS = {
    **{"map": "columns", "model": "kind", "validate": "validation", "place": "place_m"},
    **{"compliance": "frame_npm", "area": "area_m2", "height": "height_m"},
}
_FLAGS = ("align", "accept-signs")
_NUMBER_OR_NAME, _WORD = (
    r"-?[\d.]+(?:e[+-]?\d+)?\b|[A-Z][A-Z0-9,]*\b",
    r"(?:auto|comma|first|min|paper|point|recursive)\b",
)
_MAP = r"'[^']*'|[a-z]+=\S*[^\s,.;:)]"
_OPTION = re.compile(
    rf"--(?P<name>[a-z][a-z-]*)(?:[ =](?:(?P<plain>{_NUMBER_OR_NAME})|(?P<text>{_WORD}|{_MAP})))?"
)


def in_python(text: str) -> str:
    """Write `--tare auto` as `tare='auto'`, an option without a value as its name.

    >>> in_python("import with --contact-force auto, or --force-delay-s 0.01 and --align")
    "import with contact_force='auto', or force_delay_s=0.01 and align=True"
    """
    return _OPTION.sub(_argument, text)


@contextmanager
def errors_in_python() -> Iterator[None]:
    """Write the message of any error of springpot for Python."""
    try:
        yield
    except SpringpotError as error:
        error.args = tuple(in_python(str(each)) for each in error.args)
        raise


def _argument(found: re.Match[str]) -> str:
    name = found["name"]
    argument = _ARGUMENTS.get(name, name.replace("-", "_"))
    if name in _FLAGS:
        return f"{argument}=True"
    if found["text"]:
        return f"{argument}={found['text'].strip(chr(39))!r}"
    plain = found["plain"]
    if plain and "," in plain:
        plain = f"({plain.replace(',', ', ')})"
    return f"{argument}={plain}" if plain else argument
