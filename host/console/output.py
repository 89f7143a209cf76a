"""What commands print: a table for people, or one JSON object; progress on standard error."""

import json
import sys
from collections.abc import Callable, Mapping
from typing import Any

import click
from rich.console import Console
from rich.table import Table
from rich.text import Text

progress_console = Console(stderr=True)

json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")


def say(line: str) -> None:
    """Print a message on standard error."""
    click.echo(line, err=True)


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
