"""`springpot report`."""

from pathlib import Path

import click

from springpot.host.output import json_option, print_result
from springpot.host.report import write_report


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@json_option
def report(folder: Path, as_json: bool) -> None:
    """Write one self-contained HTML page on an emitted and validated FOLDER."""
    path = write_report(folder)
    print_result({"report": str(path)}, as_json, {"report": str(path)})
