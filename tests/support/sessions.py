"""Sessions that run to their end, and their logs, which repeat to the bit."""

from pathlib import Path
from typing import Any

from springpot import Recording, Session
from springpot.host.validation.validation import validate
from springpot.trainer.recordings.recording_file import read_recording
from support.peer import wait_until


def ended(*arguments: Any, **options: Any) -> Session:
    """A session that ran until it ended by itself."""
    with Session(*arguments, **{"report": list, **options}) as session:
        session.start()
        wait_until(lambda: session.over, 20, "the session does not end")
    return session


def faithful(folder: Path, log: Path) -> Recording:
    """The log of a session: what was felt is what the model says, call by call."""
    read = read_recording(log)
    assert validate(folder, [read], paced_s=0.01).mismatches == 0
    return read
