"""`springpot plot`: pictures of recordings."""

from pathlib import Path

import click

from springpot.console import json_option, paths_argument, print_result, progress_bar


@click.command()
@paths_argument("recordings")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("plots"),
    show_default=True,
    help="Folder to write into.",
)
@click.option(
    "--format",
    "forms",
    type=click.Choice(["png", "svg", "pdf"]),
    multiple=True,
    default=("png",),
    show_default=True,
    help="May be repeated.",
)
@json_option
def plot(recordings: tuple[str, ...], out: Path, forms: tuple[str, ...], as_json: bool) -> None:
    """Draw RECORDINGS: time series, loops by rate and amplitude, spectra, stiffness and loss."""
    from springpot import read_recordings
    from springpot.host.wings.report.recording_figures import write_figures

    with progress_bar("plot"):
        files = write_figures(out, read_recordings(*recordings), forms)
    print_result({"out": str(out), "files": files}, as_json, {Path(f).name: f for f in files})
