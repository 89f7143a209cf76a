"""Quality of recordings, said: on standard error, or to callers in Python as warnings."""

import warnings
from collections.abc import Callable

from springpot.codegen.errors import in_python
from springpot.codegen.messages import notice
from springpot.host.output import print_line
from springpot.trainer.recordings.quality.report import QualityReport, check_recordings
from springpot.trainer.recordings.recording_file import Recordings

_CALLER = 5  # frames above `warn`: of who called the public function that judges recordings


def report_quality(
    recordings: Recordings,
    doubt: Callable[[str], None] = print_line,
    good: Callable[[str], None] = print_line,
) -> QualityReport:
    """Say the warnings and which way is in, by default on standard error.

    recordings: or files and folders of them; `checked` of the report has them without spikes.

    Raises DataError at a refusal.
    """
    report = check_recordings(recordings)
    for kind in {finding.kind: None for finding in report.findings}:
        first, *others = (finding for finding in report.findings if finding.kind == kind)
        if first.severity == "warning":
            also = f" (and {len(others)} more: springpot check)" if others else ""
            doubt(first.line + also)
    report.refuse()
    good(report.sign_words)
    return report


def warn_of_quality(recordings: Recordings) -> QualityReport:
    """Warn in Python's way, and log which way is in. Raises DataError at a refusal."""
    return report_quality(recordings, _warn, notice)


def _warn(line: str) -> None:
    warnings.warn(in_python(line.removeprefix("warning: ")), UserWarning, stacklevel=_CALLER)
