"""`springpot plot`: pictures of recordings."""

from pathlib import Path

import click

from springpot.codegen.errors import UsageError
from springpot.host.console.output import json_option, paths_argument, print_result
from springpot.trainer.recordings.quality.report import check_recordings
from springpot.trainer.recordings.recording_file import read_recordings


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
    found = read_recordings(map(Path, recordings))
    import matplotlib as mpl

    from springpot.host.plot_style import STYLE
    from springpot.host.recording.figures import FIGURES

    report = check_recordings(found)
    files = []
    try:
        out.mkdir(parents=True, exist_ok=True)
        with mpl.rc_context(STYLE):
            for name, draw in FIGURES.items():
                figure = draw(found, report)
                for form in forms:
                    path = out / f"{name}.{form}"
                    figure.savefig(path, dpi=150)
                    files.append(str(path))
    except OSError as error:
        raise UsageError(f"{out}: {error.strerror}: choose another --out") from None
    print_result({"out": str(out), "files": files}, as_json, {Path(f).name: f for f in files})
