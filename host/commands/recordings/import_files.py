"""Files that `springpot import` writes."""

from __future__ import annotations

from pathlib import Path

from springpot.codegen.errors import UsageError
from springpot.trainer.recordings.recording import RECORDING_SUFFIX, Recording
from springpot.trainer.recordings.recording_file import write_recording


def write_all(out: Path, recordings: list[Recording]) -> list[Path]:
    """Write all recordings, or none of them where one file exists already."""
    files: dict[Path, Recording] = {}
    for recording in recordings:
        path = out / f"{recording.name}{RECORDING_SUFFIX}"
        if path in files:
            raise UsageError(
                f"{path}: both {files[path].source} and {recording.source} would be written there: "
                "import them into two folders"
            )
        if path.exists():
            raise UsageError(f"{path}: exists already: remove it or choose another --out")
        files[path] = recording
    try:
        out.mkdir(parents=True, exist_ok=True)
        for path, recording in files.items():
            write_recording(path, recording, overwrite=False)
    except FileExistsError as error:
        raise UsageError(
            f"{error.filename2 or out}: came into being meanwhile: choose another --out"
        ) from None
    except OSError as error:
        raise UsageError(f"{out}: cannot write here ({error}): choose another --out") from None
    return list(files)
