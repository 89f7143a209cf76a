"""`springpot study simulate`: the whole study with simulated people."""

import time
from pathlib import Path

import click

from springpot.console import SEED, json_option, print_result, progress_bar


@click.command("simulate")
@click.argument("study", type=click.Path(path_type=Path))
@click.option("--observers", type=click.IntRange(1, 999), required=True, help="How many people.")
@click.option("--out", type=click.Path(path_type=Path), required=True, help="A new folder.")
@click.option("--seed", type=SEED, default=0, show_default=True, help="Draws the people.")
@json_option
def simulate_(study: Path, observers: int, out: Path, seed: int, as_json: bool) -> None:
    """Run the planned STUDY with simulated people, who press the emitted C.

    Their thresholds are known (observers.json): what the report finds shows what the study can
    find. Trajectories are kept of the first of them.
    """
    from springpot.host.wings.study.folder import read_folder
    from springpot.host.wings.study.observers.simulate import simulate

    begin_s = time.monotonic()
    folder = read_folder(study)
    with progress_bar("people") as progress:
        task = progress.task_ids[0]
        found = simulate(
            folder, observers, seed, out,
            lambda done, of: progress.update(task, completed=done, total=of),
        )  # fmt: skip
    result = {
        "out": str(found.folder.path),
        "observers": observers,
        "trials": found.trials,
        "seconds": round(time.monotonic() - begin_s, 3),
    }
    rows = {"study": str(found.folder.path), "people": str(observers), "trials": str(found.trials),
            "took": f"{result['seconds']:.0f} s"}  # fmt: skip
    print_result(result, as_json, rows)
