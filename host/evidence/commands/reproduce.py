"""`springpot reproduce`: the paper's tables, figures and claims, with what was found here."""

import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import click

from springpot.codegen.errors import UsageError
from springpot.host.console.output import json_option, print_result, say
from springpot.host.simulation.objects import VARIANTS


@click.command()
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder to write.")
@click.option("--objects", help="Simulated objects, separated by commas; default: all five.")
@click.option(
    "--variant",
    type=click.Choice(VARIANTS),
    default="a",
    show_default=True,
    help="Simulated material: a quasi-linear, b stress-dependent relaxation.",
)
@click.option(
    "--recordings",
    nargs=2,
    type=click.Path(path_type=Path),
    metavar="TRAINING VALIDATION",
    help="Recordings of one object instead of simulated ones.",
)
@json_option
def reproduce(
    out: Path,
    objects: str | None,
    variant: str,
    recordings: tuple[Path, Path] | None,
    as_json: bool,
) -> None:
    """Repeat the paper's tables and figures, and say which of its claims hold here.

    Two cores take two minutes for one object and eight for all five. report.html has it all.
    """
    from springpot.host.evidence.paper.evidence import object_names, recorded, run_reproduce
    from springpot.host.evidence.paper.reproduce import ObjectRecordings, Work, simulated

    if recordings and objects:
        raise UsageError("--recordings and --objects: give one of them")
    begin = time.perf_counter()
    work = Work()
    data: Iterable[ObjectRecordings]
    if recordings:
        data = [recorded(*recordings)]
        origin = f"Data: recordings in {recordings[0].name} and {recordings[1].name}."
    else:
        names = object_names(objects)
        data = (simulated(name, variant, work) for name in names)
        origin = f"Data: simulated objects, variant {variant}; no real silicone."
    result = run_reproduce(out, data, origin, work)
    say(f"all: {time.perf_counter() - begin:.1f} s, in {out}")
    print_result(result, as_json, rows(result, out))


def rows(result: dict[str, Any], out: Path) -> dict[str, str]:
    """Return a person's view: errors of every model, then every claim, failing ones marked."""
    from springpot.host.evidence.paper.evidence import EVIDENCE
    from springpot.host.evidence.paper.page import PAPER_PAGE, headline

    found = {"data": result["data"]}
    for name, models in result["models"].items():
        found[name] = ", ".join(
            f"{kind} {metadata['rmse_n']:.3f}" for kind, metadata in models.items()
        )
    for claim in result["claims"]:
        verdict = {True: "holds", False: "FAILS", None: "open"}[claim["holds"]]
        found[f"{verdict}: {claim['claim']}"] = f"{claim['here']} (paper: {claim['paper']})"
    found["in short"] = " ".join(headline(result))
    found["written"] = f"{out}: {len(result['figures'])} figures, {EVIDENCE}"
    found["report"] = str(out / PAPER_PAGE)
    return found
