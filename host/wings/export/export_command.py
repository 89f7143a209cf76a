"""`springpot export`: recordings as CSV or MAT files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot import UsageError
from springpot.console import counted, json_option, paths_argument, print_result, progress_bar

if TYPE_CHECKING:
    from springpot.host.wings.export.exporting import ExportFormat


@click.command("export")
@paths_argument("recordings")
@click.option("--to", "form", type=click.Choice(["csv", "mat"]), required=True, help="Format.")
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder to write into.")
@json_option
def export_(recordings: tuple[str, ...], form: ExportFormat, out: Path, as_json: bool) -> None:
    """Write RECORDINGS (files or folders) as files that other programs read."""
    from springpot import read_recordings
    from springpot.host.wings.export.exporting import export_recording

    found = read_recordings(*recordings)
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
