"""`springpot study` and its parts: plan, run, report."""

from pathlib import Path

import click

from springpot.host.options import PATH, CommandGroup, device_option
from springpot.host.output import json_option, print_result, print_table, progress_bar


@click.command("plan")
@click.argument("file", type=PATH)
@click.option("--participants", type=click.IntRange(1, 999), required=True, help="How many people.")
@click.option("--out", type=PATH, required=True, help="A new folder.")
@json_option
def plan_study(file: Path, participants: int, out: Path, as_json: bool) -> None:
    """Emit the scenes of a study FILE; draw orders and sides of every trial.

    orders.csv in the folder says what the experimenter places where: participants do not see it.
    """
    from springpot.host.study.plan import write_plan

    with progress_bar("scenes"):
        plan = write_plan(file, participants, out)
    study = plan.study
    result = {
        "out": str(out),
        "participants": participants,
        "sessions": study.sessions,
        "trials": len(study.session_trials()),
        "practice": study.practice,
        "conditions": len(study.conditions()),
        "seed": study.seed,
    }
    print_result(result, as_json, {name: str(value) for name, value in result.items()})


@click.command("run")
@click.argument("study", type=PATH)
@click.option("--participant", required=True, help="Number of the participant, such as 07.")
@device_option
@json_option
def run_study(study: Path, participant: str, url: str, as_json: bool) -> None:
    """Go on with the next session of one participant of the planned STUDY.

    The participant types l or r and Enter to feel a side, and a number from 0 to 100 as the rating.
    Stopped by q, Ctrl-C or a crash, the same command goes on where it was.
    """
    from springpot.host.study.plan import read_plan
    from springpot.host.study.session import run_session

    result = run_session(read_plan(study), participant, url)
    print_result(result, as_json, {name: str(value) for name, value in result.items()})


@click.command("report")
@click.argument("study", type=PATH)
@json_option
def report_study(study: Path, as_json: bool) -> None:
    """Print who is left out, means, analysis of variance and Tukey's test of STUDY."""
    from springpot.host.study.plan import read_plan
    from springpot.host.study.report import study_report

    result = study_report(read_plan(study))
    tables = {name: rows for name, rows in result.items()
              if isinstance(rows, list) and rows and isinstance(rows[0], dict)}  # fmt: skip
    line = {name: _cell(value) for name, value in result.items() if name not in tables}
    print_result(result, as_json, line)
    for name, rows in tables.items() if not as_json else ():
        click.echo(f"\n{name}")
        print_table(list(rows[0]), [[_cell(value) for value in row.values()] for row in rows])


def _cell(value: object) -> str:
    """Return a value as people read it."""
    if isinstance(value, list):
        return ", ".join(map(str, value)) or "none"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


_COMMANDS = {name: f"{__name__}:{name}_study" for name in ("plan", "run", "report")}


@click.group("study", cls=CommandGroup, table=_COMMANDS)
def study() -> None:
    """Does it feel like the object? Plan a study, run it with people, and report."""
