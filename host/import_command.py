"""`springpot import`: files from outside -> a folder of recordings."""

import json
from pathlib import Path
from typing import Any

import click

from springpot.runtime_c.errors import UsageError
from springpot.trainer.formats.column_map import EXAMPLE, parse_map
from springpot.trainer.formats.importing import import_file
from springpot.trainer.recording import SUFFIX, Recording, Zero
from springpot.trainer.recording_file import write_recording


@click.command("import")
@click.argument(
    "files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE..."
)
@click.option("--map", "map_text", metavar=EXAMPLE, help="COL: a header or a number from 1.")
@click.option(
    "--zero",
    type=click.Choice(["none", "first", "min"]),
    default="none",
    show_default=True,
    help="Subtract nothing, the first sample or the smallest one, from each channel.",
)
@click.option("--resample-hz", type=float, help="Interpolate to this rate.")
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder to write into.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def import_(
    files: tuple[Path, ...],
    map_text: str | None,
    zero: Zero,
    resample_hz: float | None,
    out: Path,
    as_json: bool,
) -> None:
    """Turn CSV and Mach-1 text files into recordings, one HDF5 file each.

    Headers such as time_s,position_m,force_N need no --map. Where one file is refused, nothing
    is written.
    """
    mapping = parse_map(map_text) if map_text else None
    recordings, guesses = [], []
    for file in files:
        result = import_file(file, mapping, zero, resample_hz)
        click.echo(result.guess, err=True)
        recordings += result.recordings
        guesses.append(result.guess)
    written = _write(out, recordings)
    rows = [_summary(path, recording) for path, recording in written]
    if as_json:
        click.echo(json.dumps({"out": str(out), "recordings": rows, "guess": "\n".join(guesses)}))
        return
    for row in rows:
        (low_m, high_m), (low_n, high_n) = row["position_m"], row["force_n"]
        click.echo(
            f"{row['file']}  {row['samples']} samples at {row['rate_hz']:.6g} Hz, "
            f"{low_m * 1e3:.4g} to {high_m * 1e3:.4g} mm, {low_n:.4g} to {high_n:.4g} N"
        )


def _write(out: Path, recordings: list[Recording]) -> list[tuple[Path, Recording]]:
    """Write all recordings, or none of them where one file exists already."""
    files: dict[Path, Recording] = {}
    for recording in recordings:
        path = out / f"{recording.name}{SUFFIX}"
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
            write_recording(path, recording)
    except OSError as error:
        raise UsageError(f"{out}: cannot write here ({error}): choose another --out") from None
    return list(files.items())


def _summary(path: Path, recording: Recording) -> dict[str, Any]:
    return {
        "name": recording.name,
        "file": str(path),
        "samples": len(recording.position_m),
        "rate_hz": recording.rate_hz,
        "position_m": [float(recording.position_m.min()), float(recording.position_m.max())],
        "force_n": [float(recording.force_n.min()), float(recording.force_n.max())],
    }
