"""Messages for callers in Python: arguments in place of options, quality as warnings."""

import re
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields

from springpot.codegen.errors import SpringpotError
from springpot.codegen.messages import notice
from springpot.host.output import say
from springpot.trainer.recordings.conditioning import Conditioning
from springpot.trainer.recordings.formats.importing import ImportOptions
from springpot.trainer.recordings.quality.report import QualityReport, check_recordings
from springpot.trainer.recordings.recording_file import Recordings

_CALLER = 5  # frames above `warn`: of who called the public function that judges recordings
# The options that are not the argument with the same name.
_ARGUMENTS = {"map": "columns", "model": "kind", "validate": "validation", "place": "place_m"}
# Those that are not of a function, but of the settings that it takes.
_OWNERS = {item.name: kind.__name__ for kind in (Conditioning, ImportOptions)
           for item in fields(kind)}  # fmt: skip
_FLAGS = ("align", "accept-misfit", "accept-signs")
_NUMBER_OR_NAME = r"-?[\d.]+(?:e[+-]?\d+)?\b|-?[A-Z][A-Z0-9_,]*\b"
_WORD = r"(?:auto|comma|first|min|paper|point|recursive)\b"
_MAP = r"'[^']*'|[a-z]+=\S*[^\s,.;:)]"
_OPTION = re.compile(
    rf"--(?P<name>[a-z][a-z-]*)(?:[ =](?:(?P<plain>{_NUMBER_OR_NAME})|(?P<text>{_WORD}|{_MAP})))?"
)


def report_quality(
    recordings: Recordings, doubt: Callable[[str], None] = say, good: Callable[[str], None] = say
) -> QualityReport:
    """Say the warnings and which way is in, by default on standard error.

    recordings: or files and folders of them; `checked` of the report has them without spikes.

    Raises DataError at a refusal.
    """
    report = check_recordings(recordings)
    for kind in {finding.kind: None for finding in report.findings}:
        first, *others = (found for found in report.findings if found.kind == kind)
        if first.severity == "warning":
            also = f" (and {len(others)} more: springpot check)" if others else ""
            doubt(first.line + also)
    report.refuse()
    good(report.sign_words)
    return report


def warn_of_quality(recordings: Recordings) -> QualityReport:
    """Warn in Python's way, and log which way is in. Raises DataError at a refusal."""
    with errors_in_python():
        return report_quality(recordings, _warn, notice)


def _warn(line: str) -> None:
    warnings.warn(in_python(line.removeprefix("warning: ")), UserWarning, stacklevel=_CALLER)


def in_python(text: str) -> str:
    """Write `--zero min` as `zero='min'`, an option without a value as its name; the commands too.

    >>> in_python("import with --contact-force auto, or --zero first")
    "import with Conditioning(contact_force='auto'), or zero='first'"
    """
    text = text.replace("`springpot import`", "springpot.import_recordings")
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
    plain = found["plain"] or ("True" if name in _FLAGS else "")
    if "," in plain:
        plain = f"({plain.replace(',', ', ')})"
    value = repr(found["text"].strip("'")) if found["text"] else plain
    given = f"{argument}={value}" if value else argument
    return f"{_OWNERS[argument]}({given})" if argument in _OWNERS else given
