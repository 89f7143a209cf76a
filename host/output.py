"""What commands print: a table for people, or one JSON object; progress on standard error."""

import json
import logging
import sys
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn
from rich.table import Table
from rich.text import Text

from springpot.codegen.messages import NOTICES
from springpot.codegen.types import JsonMapping

progress_console = Console(stderr=True)
RESULT = "bench.json"  # of a benchmark, in its folder

json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")


def print_line(line: str) -> None:
    """Print a message on standard error."""
    click.echo(line, err=True)


def describe_os_error(error: OSError) -> str:
    """One line: the place, if it is known, the system's reason, and what to do."""
    place = f"{error.filename}: " if error.filename else ""
    return f"{place}{error.strerror or error}: choose another place, or free this one"


class _ProgressLine(logging.Handler):
    """Show the log of long work beside the bar: records carry `done` of `total` steps."""

    def __init__(self, progress: Progress, text: str) -> None:
        super().__init__()
        self._progress, self._text = progress, text
        self._task = progress.add_task(text, total=None)

    def emit(self, record: logging.LogRecord) -> None:
        done, total = (getattr(record, name, None) for name in ("done", "total"))
        if done is not None:
            text = f"{self._text}, {record.getMessage()}"
            self._progress.update(self._task, completed=done, total=total, description=text)


class _SaidLine(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        print_line(f"springpot: {record.getMessage()}")


@contextmanager
def notices_printed() -> Iterator[None]:
    """Print what is noticed, and what Python warns of, on standard error while this lasts."""

    def show(message: Warning | str, category: type[Warning], *place: Any) -> None:
        if category is UserWarning:  # of the Python interface, which a command may call
            print_line(f"warning: {message}")
        else:
            shown(message, category, *place)

    shown: Any = warnings.showwarning
    warnings.showwarning = show  # type: ignore[assignment]
    logger, handler = logging.getLogger(NOTICES), _SaidLine()
    level, above = logger.level, logger.propagate
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    logger.propagate = False
    try:
        yield
    finally:
        warnings.showwarning = shown
        logger.removeHandler(handler)
        logger.setLevel(level)
        logger.propagate = above


@contextmanager
def progress_bar(text: str) -> Iterator[Progress]:
    """A bar on standard error that says how far the work is; it swings until that is known."""
    logger = logging.getLogger("springpot")
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(bar_width=20))
    terminal = progress_console.is_terminal  # elsewhere a bar would leave an empty line
    with Progress(
        *columns, console=progress_console, transient=True, disable=not terminal
    ) as progress:
        handler, level = _ProgressLine(progress, text), logger.level
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
        try:
            yield progress
        finally:
            logger.removeHandler(handler)
            logger.setLevel(level)


def print_result(result: JsonMapping, as_json: bool, rows: Mapping[str, str]) -> None:
    """Print `result` as JSON, or `rows` as a table of two columns."""
    if as_json:
        print_json(result)
    else:
        print_table(("", ""), rows.items(), header=False)


def print_json(result: JsonMapping) -> None:
    """Print one JSON object; a dataclass in it is an object of its fields, a path is text."""
    click.echo(json.dumps(result, allow_nan=False, default=shown_fields))


def shown_fields(value: Any) -> Any:
    """Return the fields of a dataclass that its repr shows, by name; a path as text."""
    if is_dataclass(value):
        return {item.name: getattr(value, item.name) for item in fields(value) if item.repr}
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"{value!r} is no JSON value")


def print_table(
    columns: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    header: bool = True,
    names: int | None = None,
    width: int | None = None,
) -> None:
    """Print a table for people; cells are whole. names: the column of names; the others are
    numbers then, and align right.
    """
    table = Table(show_header=header, box=None, pad_edge=False)
    for place, name in enumerate(columns):
        is_number = names is not None and place != names
        table.add_column(Text(name), justify="right" if is_number else "left", overflow="fold")
    for row in rows:
        table.add_row(*map(Text, row))  # text as it is: [cc] is no markup
    Console(file=sys.stdout, width=width).print(table)
