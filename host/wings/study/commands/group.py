"""`springpot study`: plan, run, simulate, report."""

import click

from springpot.console import LazyCommand, LazyGroup

_HERE = "springpot.host.wings.study.commands"
_COMMANDS = {
    "plan": LazyCommand(f"{_HERE}.plan:plan",
        "Freeze a study FILE into a folder: scenes, orders, codes."),
    "run": LazyCommand(f"{_HERE}.run:run_study",
        "Go on with the next session of one participant of the planned STUDY."),
    "simulate": LazyCommand(f"{_HERE}.simulate:simulate_",
        "Run the planned STUDY with simulated people, who press the emitted C."),
    "report": LazyCommand(f"{_HERE}.report:report_",
        "Open the key of STUDY; write a page and tables of its results."),
}  # fmt: skip


@click.group(cls=LazyGroup, find_commands=lambda: _COMMANDS)
def study() -> None:
    """Does it feel like the object? Plan a study, run it with people, and report."""
