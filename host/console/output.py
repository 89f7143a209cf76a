"""What commands print: a table for people, or one JSON object; progress on standard error."""

import json
import logging
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import click
from rich.console import Console
from rich.status import Status
from rich.table import Table
from rich.text import Text

progress_console = Console(stderr=True)

json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")


def say(line: str) -> None:
    """Print a message on standard error."""
    click.echo(line, err=True)


class _StatusLine(logging.Handler):
    """What long work logs, behind the spinner's text."""

    def __init__(self, status: Status, text: str) -> None:
        super().__init__()
        self._status, self._text = status, text

    def emit(self, record: logging.LogRecord) -> None:
        self._status.update(f"{self._text}, {record.getMessage()}")


@contextmanager
def spinner(text: str) -> Iterator[Status]:
    """A spinner on standard error that says how far the trainer is."""
    logger = logging.getLogger("springpot.trainer")
    with progress_console.status(text) as status:
        handler, level = _StatusLine(status, text), logger.level
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
        try:
            yield status
        finally:
            logger.removeHandler(handler)
            logger.setLevel(level)


def print_result(result: Mapping[str, Any], as_json: bool, rows: Mapping[str, str]) -> None:
    """Print `result` as JSON, or `rows` as a table of two columns."""
    if as_json:
        click.echo(json.dumps(result, allow_nan=False))
        return
    table = Table(show_header=False, box=None, pad_edge=False)
    for name, value in rows.items():
        table.add_row(Text(name), Text(value, overflow="fold"))
    Console(file=sys.stdout).print(table)


def paths_argument(name: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """One or more file or folder arguments."""
    return click.argument(name, nargs=-1, required=True, type=click.Path())
