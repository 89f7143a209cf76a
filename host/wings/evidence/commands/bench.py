"""`springpot bench`: error against run time against bytes, the front, and what to pick."""

import shlex
import sys
from pathlib import Path
from typing import Any

import click

from springpot.basics import Target
from springpot.console import SEED, json_option, print_result, recordings_given, say
from springpot.modelling import KINDS


@click.command()
@recordings_given("Recording or folder to train on")
@click.option(
    "--validate", "validation", multiple=True, type=click.Path(), metavar="REC",
    help="Recording or folder to report on; default: a fifth of the others is kept for it.",
)  # fmt: skip
@click.option(
    "--target", type=click.Choice(["host", "cortex-m4f", "cortex-m7", "rv32imafc"]),
    default="cortex-m4f", show_default=True, help="Board whose flash is counted.",
)  # fmt: skip
@click.option(
    "--out", type=click.Path(path_type=Path), default=Path("bench"), show_default=True,
    help="Folder of the results; what is there is not computed again.",
)  # fmt: skip
@click.option(
    "--model", "kinds", multiple=True, type=click.Choice(list(KINDS)),
    help="Kind to sweep; may be repeated; default: all.",
)  # fmt: skip
@click.option("--dask", metavar="ADDRESS", help="Scheduler of a Dask cluster to sweep on.")
@click.option("--seed", type=SEED, default=0, show_default=True)
@json_option
def bench(
    recordings: tuple[str, ...],
    validation: tuple[str, ...],
    target: Target,
    out: Path,
    kinds: tuple[str, ...],
    dask: str | None,
    seed: int,
    as_json: bool,
) -> None:
    """Measure every kind and size of model on your recordings; mark the front; pick."""
    from springpot import read_recordings
    from springpot.console import report_quality
    from springpot.host.wings.evidence.benchmark.run import Bench, run_bench
    from springpot.host.wings.evidence.splits import holdout

    training = read_recordings(*recordings)
    report_quality(training)
    if validation:
        testing = read_recordings(*validation)
    else:
        training, testing = holdout(training, seed)
        say(f"kept for validation: {', '.join(item.name for item in testing)}")
    asked = Bench(tuple(training), tuple(testing), target, seed, kinds, dask)
    result = run_bench(asked, out, shlex.join(["springpot", *sys.argv[1:]]))
    print_result(result, as_json, bench_rows(result, out))


def bench_rows(result: dict[str, Any], out: Path) -> dict[str, str]:
    """Return a person's view: the picks, the front, and where the rest is."""
    from springpot.host.wings.evidence.benchmark.labels import label, point_line
    from springpot.host.wings.evidence.benchmark.point import Refused, points_of
    from springpot.host.wings.evidence.benchmark.store import RESULT
    from springpot.simulation import own_class_line
    from springpot.validation import seen_line

    points, training = points_of(result), result["recordings"]["training"]
    by_key = {point.key: point for point in points}
    told = seen_line(result["seen"], len(result["recordings"]["validation"]))
    rows = {"training data": told} if told else {}
    if kin := own_class_line(recording["source"] for recording in training):
        rows["judge"] = kin
    picks: dict[str, list[str]] = {}
    for name, found in result["picks"].items():
        point = found["point"]
        pick = f"{point_line(by_key[point])}: {found['why']}" if point else found["why"]
        picks.setdefault(pick, []).append(name)
    rows |= {f"pick {', '.join(names)}": pick for pick, names in picks.items()}
    for point in sorted((p for p in points if p.pareto), key=lambda p: p.tick_ns_hot):
        rows.setdefault(f"front {point.tick_ns_hot:.0f} ns", point_line(point))
    for refused in (Refused(**facts) for facts in result["refused"]):
        rows[f"refused {label(refused)}"] = refused.error
    rows["points"] = (
        f"{len(points)}, {result['computed']} of them computed now in {result['wall_s']:.0f} s"
    )
    rows["written"] = f"{out / RESULT}; `springpot report {out}` makes the page"
    return rows
