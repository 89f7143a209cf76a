"""The quality of recordings, before they are used: warnings as messages, a refusal as an error."""

from collections.abc import Sequence

from springpot.host.console.output import say
from springpot.trainer.recordings.quality.report import QualityReport, check_recordings
from springpot.trainer.recordings.recording import Recording


def report_quality(recordings: Sequence[Recording]) -> QualityReport:
    """Print the warnings and which way is in on standard error; raise DataError at a refusal."""
    report = check_recordings(recordings)
    for finding in report.findings:
        if finding.severity == "warning":
            say(finding.line)
    report.refuse()
    say(report.figures["signs"])
    return report
