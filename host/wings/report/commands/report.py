"""`springpot report`."""

from pathlib import Path

import click

from springpot.console import json_option, print_result, progress_bar


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@json_option
def report(folder: Path, as_json: bool) -> None:
    """Write a self-contained HTML page on FOLDER: a benchmark, or an emitted, validated scene."""
    from springpot.console import part
    from springpot.host.wings.report.scene_page import write_report

    of_bench = part("bench-report")
    with progress_bar("report"):
        path = (of_bench and of_bench(folder)) or write_report(folder)
    print_result({"report": str(path)}, as_json, {"report": str(path)})
