"""`springpot import`: files from outside -> a folder of recordings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from springpot.codegen.errors import UsageError
from springpot.host.options import NOT_NEGATIVE, PATH, FiniteRange, field_option
from springpot.host.output import json_option, print_json, print_line, progress_bar
from springpot.trainer.recordings.conditioning import Conditioning
from springpot.trainer.recordings.formats.column_map import MAP_EXAMPLE, DecimalMark, parse_map

if TYPE_CHECKING:
    from springpot.trainer.recordings.quality.report import QualityReport
    from springpot.trainer.recordings.recording import Zero


_OF_REPORT = ("name", "samples", "rate_hz", "position_m", "force_n", "signs")  # of a recording


@click.command("import")
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE|FOLDER...")
@click.option("--map", "map_text", metavar=MAP_EXAMPLE, help="COL: a header or a number from 1.")
@click.option(
    "--zero",
    type=click.Choice(["none", "first", "min"]),
    default="none",
    show_default=True,
    help="Subtract nothing, the first sample or the smallest one, from each channel.",
)
@click.option("--resample-hz", type=float, help="Interpolate to this rate.")
@click.option("--decimal", type=click.Choice(["point", "comma"]), help="CSV: else guessed.")
@field_option(Conditioning, "position_delay_s", FiniteRange())
@field_option(Conditioning, "force_delay_s", FiniteRange())
@field_option(Conditioning, "align", None)
@field_option(Conditioning, "mass_kg", NOT_NEGATIVE)
@click.option("--tare", metavar="auto|N", help="Force without contact.")
@click.option(
    "--contact-force",
    metavar="auto|N",
    help="Put position 0 where force passes this; auto: just above the noise.",
)
@click.option(
    "--rest-s",
    type=NOT_NEGATIVE,
    help="Time between the presses, if all are of one object in this order.",
)
@click.option(
    "--place",
    metavar="X,Y",
    help="Where the object was pressed, such as 5,10mm, or the columns of it: x_mm,y_mm.",
)
@field_option(Conditioning, "accept_signs", None)
@click.option("--out", required=True, type=PATH, help="Folder to write into.")
@json_option
def import_(
    files: tuple[Path, ...],
    map_text: str | None,
    zero: Zero,
    resample_hz: float | None,
    decimal: DecimalMark | None,
    rest_s: float | None,
    place: str | None,
    out: Path,
    as_json: bool,
    **of_rig: Any,  # options of the same names as fields of Conditioning
) -> None:
    """Turn CSV, MAT and HDF5 files and journals into recordings.

    One HDF5 file each. Headers such as time_s,position_m,force_N need no --map. Where one file is
    refused, nothing is written.
    """
    from springpot.host.files import write_in_folder
    from springpot.host.quality import report_quality
    from springpot.trainer.recordings.formats.importing import (
        ImportOptions,
        import_set,
        parse_place_option,
    )

    mapping = parse_map(map_text) if map_text else None
    options = ImportOptions(
        decimal, Conditioning(**of_rig), place_m=parse_place_option(place) if place else None
    )
    if out.exists() and not out.is_dir():
        raise UsageError(f"--out {out}: is a file: give a folder to write recordings into")
    with progress_bar("import"):
        recordings, guesses, notes = import_set(files, mapping, zero, resample_hz, options, rest_s)
    _say_guesses(guesses)
    for note in notes:
        print_line(note)
    report = report_quality(recordings)
    rows = _rows(write_in_folder(out, report.checked, overwrite=False), report)
    if not as_json:
        _show(rows)
        return
    findings = [finding.metadata() for finding in report.findings]
    print_json(
        {
            "out": out,
            "recordings": rows,
            "guess": "\n".join(guesses.values()),
            "findings": findings,
        }
    )


def _say_guesses(guesses: Mapping[Path, str]) -> None:
    """Say how the files were understood: once for all that were understood alike."""
    alike: dict[str, list[Path]] = {}
    for file, guess in guesses.items():
        alike.setdefault(guess.removeprefix(f"{file}: "), []).append(file)
    for guess, (first, *others) in alike.items():
        print_line(f"{first}{f' and {len(others)} more' if others else ''}: {guess}")


def _rows(files: Sequence[Path], report: QualityReport) -> list[dict[str, Any]]:
    """Figures of each recording, with the file that it is in."""
    from springpot.trainer.recordings.quality.units import summarise_press

    pairs = zip(files, report.recordings, report.checked, strict=True)
    return [
        {
            "file": str(file),
            **{key: figures[key] for key in _OF_REPORT},
            "glance": summarise_press(recording).words,
        }
        for file, figures, recording in pairs
    ]


def _show(rows: Sequence[dict[str, Any]]) -> None:
    """Print two lines of each recording; of several, a third where they point elsewhere."""
    printed = {""} if len(rows) > 1 else {row["signs"]["words"] for row in rows}
    for row in rows:
        (low_m, high_m), (low_n, high_n) = row["position_m"], row["force_n"]
        words = row["signs"]["words"]
        click.echo(
            f"{row['file']}  {row['samples']} samples at {row['rate_hz']:.6g} Hz, "
            f"{low_m * 1e3:.4g} to {high_m * 1e3:.4g} mm, {low_n:.4g} to {high_n:.4g} N\n"
            f"  {row['glance']}" + ("" if words in printed else f"\n  {words}")
        )
        printed.add(words)
