"""`springpot export`, recordings as CSV or MAT files, and `springpot predict` along them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot import UsageError
from springpot.console import counted, json_option, paths_argument, print_result, progress_bar, say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from springpot import Recording
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
    _names_of(found, "export them into two folders")
    with progress_bar("export"):
        files = [
            str(export_recording(out, recording, form)) for recording in counted(found, "writing")
        ]
    rows = {recording.name: file for recording, file in zip(found, files, strict=True)}
    print_result({"out": str(out), "files": files}, as_json, rows)


@click.command("predict")
@click.argument("model", type=click.Path(path_type=Path))
@click.argument("recordings", nargs=-1, required=True, type=click.Path(), metavar="REC...")
@click.option(
    "--out",
    required=True,
    type=click.Path(path_type=Path),
    help="Folder to write a CSV file of each into.",
)
@json_option
def predict(model: Path, recordings: tuple[str, ...], out: Path, as_json: bool) -> None:
    """Write the force of MODEL along recordings (files or folders), beside the measured one.

    The force is the model's own, without coupling and guard, and never pulls at a surface.
    """
    import numpy as np

    from springpot import read_model, read_recordings
    from springpot.host.wings.export.exporting import write_prediction
    from springpot.modelling import (
        extrapolation,
        limited_n,
        require_compatible,
        sign_doubts,
        unplaced,
    )
    from springpot.validation import rms

    fitted = read_model(model)
    found = read_recordings(*recordings)
    for doubt in sign_doubts(found):
        say(f"warning: {doubt}")
    names = _names_of(found, "give one of them at a time")
    forces = []
    for recording in found:
        require_compatible(recording, fitted)
        forces.append(limited_n(fitted, recording))
        for doubt in filter(None, (unplaced(fitted, recording), extrapolation(fitted, recording))):
            say(f"warning: {doubt}")
    files = [
        str(write_prediction(out, recording, force_n))
        for recording, force_n in zip(found, forces, strict=True)
    ]
    errors_n = [item.force_n - force_n for item, force_n in zip(found, forces, strict=True)]
    rmse_n = rms(np.concatenate(errors_n))
    peak_n = max(float(np.max(np.abs(item.force_n))) for item in found)
    percent = 100.0 * rmse_n / peak_n if peak_n > 0.0 else None
    result = {"out": str(out), "files": files, "rmse_n": rmse_n, "rmse_percent_of_peak": percent}
    rows = dict(zip(names, files, strict=True))
    rows["RMSE"] = f"{rmse_n:.4g} N" + (f", {percent:.3g} % of peak" if percent is not None else "")
    print_result(result, as_json, rows)


def _names_of(recordings: Sequence[Recording], to_do: str) -> list[str]:
    """Names of the recordings, by which files are named. Raises UsageError if two have one."""
    names = [recording.name for recording in recordings]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise UsageError(f"two recordings are named {twice[0]}: {to_do}")
    return names
