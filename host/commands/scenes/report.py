"""`springpot report`."""

from pathlib import Path

import click

from springpot.host.console.output import json_option, print_result, progress_bar


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@json_option
def report(folder: Path, as_json: bool) -> None:
    """Write a self-contained HTML page on FOLDER: a benchmark, or an emitted, validated scene."""
    from springpot.host.benchmark.store import RESULT

    with progress_bar("report"):
        if (folder / RESULT).exists():
            from springpot.host.benchmark.report import write_bench_report

            path = write_bench_report(folder)
        else:
            from springpot.host.validation.report import write_report

            path = write_report(folder)
    print_result({"report": str(path)}, as_json, {"report": str(path)})
