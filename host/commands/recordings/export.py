"""`springpot export`: recordings as CSV or MAT files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot.codegen.errors import UsageError
from springpot.codegen.progress import counted
from springpot.host.console.options import PATH
from springpot.host.console.output import json_option, paths_argument, print_result, progress_bar

if TYPE_CHECKING:
    from springpot.trainer.recordings.formats.exporting import ExportFormat


@click.command("export")
@paths_argument("recordings")
@click.option("--to", "form", type=click.Choice(["csv", "mat"]), required=True, help="Format.")
@click.option("--out", required=True, type=PATH, help="Folder to write into.")
@json_option
def export_(recordings: tuple[str, ...], form: ExportFormat, out: Path, as_json: bool) -> None:
    """Write RECORDINGS (files or folders) as files that other programs read."""
    from springpot.trainer.recordings.formats.exporting import export_recording
    from springpot.trainer.recordings.recording_file import read_recordings

    found = read_recordings(map(Path, recordings))
    names = [recording.name for recording in found]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise UsageError(f"two recordings are named {twice[0]}: export them into two folders")
    with progress_bar("export"):
        files = [
            str(export_recording(out, recording, form)) for recording in counted(found, "writing")
        ]
    rows = {recording.name: file for recording, file in zip(found, files, strict=True)}
    print_result({"out": str(out), "files": files}, as_json, rows)
