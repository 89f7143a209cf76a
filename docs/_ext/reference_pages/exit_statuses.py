"""The exit statuses of the command line, from the errors and their table in host/cli.py."""

import inspect

from springpot.codegen import errors
from springpot.host.cli import exit_status

_OTHERS = {0: ("", "Done."), 1: ("", "A check failed, or there is no C compiler."),
           130: ("", "Interrupted.")}  # fmt: skip


def statuses() -> dict[int, tuple[str, str]]:
    """Status: name of the error in Python, and what it means."""
    kinds = [
        kind for _, kind in inspect.getmembers(errors, inspect.isclass)
        if issubclass(kind, errors.SpringpotError) and kind is not errors.SpringpotError
    ]  # fmt: skip
    found = {
        exit_status(kind()): (kind.__name__, (inspect.getdoc(kind) or "").split("\n\n")[0])
        for kind in kinds
    }
    assert len(found) == len(kinds)
    return dict(sorted({**_OTHERS, **found}.items()))


def exit_status_table() -> str:
    """Markdown: a table."""
    rows = [
        f"| {status} | {meaning} | `{name}` |" if name
        else f"| {status} | {meaning} | |"
        for status, (name, meaning) in statuses().items()
    ]  # fmt: skip
    return "\n".join(["| status | meaning | in Python |", "| --- | --- | --- |", *rows])
