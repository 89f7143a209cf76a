"""`springpot study`: plan, run, simulate, report."""

import click

from springpot.host.console.lazy_group import LazyCommand, LazyGroup

_COMMANDS = {
    "plan": LazyCommand("study.plan:plan",
        "Freeze a study FILE into a folder: scenes, orders, codes."),
    "run": LazyCommand("study.run:run_study",
        "Go on with the next session of one participant of the planned STUDY."),
    "simulate": LazyCommand("study.simulate:simulate_",
        "Run the planned STUDY with simulated people, who press the emitted C."),
    "report": LazyCommand("study.report:report_",
        "Open the key of STUDY; write a page and tables of its results."),
}  # fmt: skip


@click.group(cls=LazyGroup, commands_by_name=_COMMANDS)
def study() -> None:
    """Does it feel like the object? Plan a study, run it with people, and report."""
