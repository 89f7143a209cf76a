"""`springpot check`: what is wrong with recordings, and what that means for a model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from springpot.host.options import recordings_argument
from springpot.host.output import json_option, print_json, print_table, progress_bar

if TYPE_CHECKING:
    from springpot.trainer.recordings.quality.report import QualityReport


@click.command("check")
@recordings_argument
@json_option
def check_(recordings: tuple[str, ...], as_json: bool) -> None:
    """Report the quality of RECORDINGS (files or folders); refusals end with status 3."""
    from springpot.trainer.recordings.quality.report import check_recordings
    from springpot.trainer.recordings.recording_file import read_recordings

    with progress_bar("check"):
        report = check_recordings(read_recordings(map(Path, recordings)))
    if as_json:
        print_json(report.as_dict())
    else:
        _show(report)
    report.refuse()


def _show(report: QualityReport) -> None:
    """Print a person's view of a report."""
    columns = ["recording", "Hz", "s", "mm", "N", "cycles Hz", "N/mm", "loss rad"]
    rows = [_row(figures) for figures in report.recordings]
    if any("place_m" in figures for figures in report.recordings):
        columns.insert(1, "place mm")
        for row, figures in zip(rows, report.recordings, strict=True):
            place_m = figures.get("place_m", ())
            row.insert(1, ", ".join(f"{1e3 * at:.4g}" for at in place_m) or "-")
    print_table(columns, rows, width=140)
    click.echo(report.figures["signs"])
    known_n = (report.figures["noise_floor_n"], report.figures["sensor_noise_n"])
    known = next((f"{floor_n:.3g} N" for floor_n in known_n if floor_n is not None), "not known")
    click.echo(f"noise floor: {known}, {report.figures['noise_floor']}")
    skew_s, doubt_s = report.figures["skew_s"], report.figures["skew_uncertainty_s"]
    if skew_s is None:
        click.echo(
            "delay of force behind position: not measured, for these cycles do not separate it "
            "from loss: record one amplitude at five frequencies or more, the highest four times "
            "the lowest; loss not quoted"
        )
    else:
        click.echo(
            f"delay of force behind position: {skew_s * 1e3:.2g} +- {doubt_s * 1e3:.2g} ms, if the "
            "loss angle goes with the logarithm of frequency"
        )
    for finding in report.findings:
        click.echo(finding.line)


def _row(figures: dict[str, Any]) -> list[str]:
    """Return a recording's row of the table: ranges, and stiffness and loss angle of its cycles."""
    (low_m, high_m), (low_n, high_n) = figures["position_m"], figures["force_n"]
    row = [
        figures["name"],
        f"{figures['rate_hz']:.6g}",
        f"{figures['duration_s']:.4g}",
        f"{low_m * 1e3:.4g} .. {high_m * 1e3:.4g}",
        f"{low_n:.4g} .. {high_n:.4g}",
    ]
    cycles = figures["cycles"]
    if cycles is None:
        return [*row, "-", "-", "-"]
    loss, quoted = cycles["loss"], "-"
    if loss and loss["angle_uncertainty_rad"] <= abs(loss["angle_rad"]):  # else nothing is known
        quoted = f"{loss['angle_rad']:.3f} +- {loss['angle_uncertainty_rad']:.2g}"
    stiffness = f"{cycles['stiffness_npm'] * 1e-3:.4g}"
    return [*row, f"{cycles['frequency_hz']:.3g}", stiffness, quoted]
