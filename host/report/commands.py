"""`springpot demo` and `springpot report`."""

from pathlib import Path

import click

from springpot.host.console.output import json_option, print_result, progress_bar


@click.command()
@click.option("--out", type=click.Path(path_type=Path), default=Path("demo"), show_default=True)
@click.option("--object", "object_name", default="ecoflex-00-30", show_default=True)
@json_option
def demo(out: Path, object_name: str, as_json: bool) -> None:
    """Do the whole job on a simulated object: record, train, emit, build, validate, report."""
    from springpot.host.commands.emit import emission_rows
    from springpot.host.commands.validate import validation_rows
    from springpot.host.report.demo import run_demo
    from springpot.host.validation.validation import fail_on_mismatch

    done = run_demo(out, object_name)
    result = {
        "object": object_name,
        "report": str(done.report),
        "seconds": done.seconds,
        "emit": done.emission.as_dict(),
        "validate": done.validation.as_dict(),
    }
    rows = {
        "object": f"{object_name}, simulated",
        "training": f"{done.fit.rows} rows, fit {done.fit.fit_s:.2f} s",
        **emission_rows(done.emission),
        **validation_rows(done.validation),
        "report": str(done.report),
    }
    print_result(result, as_json, rows)
    fail_on_mismatch(out / "c", done.validation)


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@json_option
def report(folder: Path, as_json: bool) -> None:
    """Write a self-contained HTML page on FOLDER: a benchmark, or an emitted, validated scene."""
    from springpot.host.bench.page import write_bench_page
    from springpot.host.report.scene_page import write_report

    with progress_bar("report"):
        if (folder / "bench.json").is_file():
            path = write_bench_page(folder)
        else:
            path = write_report(folder)
    print_result({"report": str(path)}, as_json, {"report": str(path)})
