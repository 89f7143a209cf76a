"""The quality of recordings, before they are used: warnings as messages, a refusal as an error."""

from collections.abc import Sequence

from springpot.host.console.output import say
from springpot.trainer.recordings.quality.report import QualityReport, check_recordings
from springpot.trainer.recordings.recording import Recording


def report_quality(recordings: Sequence[Recording]) -> QualityReport:
    """Print the warnings and which way is in on standard error; raise DataError at a refusal."""
    report = check_recordings(recordings)
    for kind in {finding.kind: None for finding in report.findings}:
        first, *others = (found for found in report.findings if found.kind == kind)
        if first.severity == "warning":
            also = f" (and {len(others)} more: springpot check)" if others else ""
            say(first.line + also)
    report.refuse()
    say(report.sign_words)
    return report
