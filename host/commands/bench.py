"""`springpot bench`: error against run time against bytes, and the front."""

import shlex
import sys
from pathlib import Path

import click

from springpot.codegen.messages import counted_noun
from springpot.codegen.scene import Target
from springpot.host.options import PATH, SEED, recordings_given, recordings_option
from springpot.host.output import json_option, print_json, print_line, print_table


@click.command()
@recordings_given
@recordings_option(
    "--validate", "validation", "Recording or folder to report on; default: a fifth of the others"
)
@click.option(
    "--target", type=click.Choice(["host", "cortex-m4f", "cortex-m7", "rv32imafc"]),
    default="cortex-m4f", show_default=True, help="Board for which flash is counted.",
)  # fmt: skip
@click.option(
    "--out", type=PATH, default=Path("bench"), show_default=True,
    help="Folder of the results; what is there is not computed again.",
)  # fmt: skip
@click.option(
    "--model", "models", multiple=True, metavar="KIND|FILE",
    help="Kind of model, or a model's file; may be repeated; default: every kind.",
)  # fmt: skip
@click.option("--dask", metavar="ADDRESS", help="Scheduler of a Dask cluster to fit on.")
@click.option("--seed", type=SEED, default=0, show_default=True, help="Of random choices of a fit.")
@json_option
def bench(
    recordings: tuple[str, ...],
    validation: tuple[str, ...],
    target: Target,
    out: Path,
    models: tuple[str, ...],
    dask: str | None,
    seed: int,
    as_json: bool,
) -> None:
    """Train kinds and sizes of model on REC, and measure error, run time and bytes; the front."""
    from springpot import read_recordings
    from springpot.host.bench.bench import Bench, holdout, run_bench
    from springpot.host.pages.reports import point_label, write_bench_page
    from springpot.host.quality import report_quality
    from springpot.host.validation.seen import training_overlap_sentence

    training = report_quality(recordings).checked
    if validation:
        testing = read_recordings(*validation)
    else:
        training, testing = holdout(training, seed)
        print_line(f"kept for validation: {', '.join(item.name for item in testing)}")
    asked = Bench(tuple(training), tuple(testing), target, seed, models, dask)
    result = run_bench(asked, out, shlex.join(["springpot", *sys.argv[1:]]))
    page = write_bench_page(out)
    if as_json:
        print_json(result)
        return
    if seen := training_overlap_sentence(result["seen"], len(testing)):
        print_line(seen)
    counts = ("instructions",) if target != "host" else ()  # no PC is emulated
    columns = ("error, %", "emitted, %", "tick, ns", "flash", "RAM", *counts, "model")
    alone = [point for point in result["points"] if point["coupling"]]  # the front, named files
    rows = [
        (f"{p['rmse_percent_of_peak']:.2g}", _digits(p["rendered_rmse_percent_of_peak"]),
         f"{p['tick_ns_hot']:.0f}",
         *(_known(p[key]) for key in ("flash_bytes", "ram_bytes", *counts)),
         point_label(p) + ("" if p["bounded"] else ", not bounded in every hand"))
        for p in alone
    ]  # fmt: skip
    print_table(columns, rows, names=len(columns) - 1)
    if others := len(result["points"]) - len(alone):
        print_line(f"{counted_noun(others, 'more model')}, each no better than one of these")
    for refused in result["refused"]:
        print_line(f"refused: {point_label(refused)}: {refused['error']}")
    print_line(f"written: {page}; the models are in {out / 'models'}")


def _known(value: float | None) -> str:
    return "-" if value is None else f"{value:.6g}"


def _digits(value: float | None) -> str:
    return "-" if value is None else f"{value:.2g}"
