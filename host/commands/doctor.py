"""`springpot doctor`."""

import json
import sys

import click
from rich.console import Console
from rich.table import Table

from springpot.host.console.output import json_option


@click.command()
@json_option
def doctor(as_json: bool) -> None:
    """Show what this machine offers, and what to do where something is missing."""
    from springpot.host.devices.doctor import examine

    findings = examine()
    if as_json:
        click.echo(json.dumps({"findings": [finding.as_dict() for finding in findings]}))
    else:
        table = Table("what", "", box=None, pad_edge=False)
        for column in ("seen", "what to do"):
            table.add_column(column, overflow="fold")  # paths are whole
        for finding in findings:
            mark = "ok" if finding.found else "--"
            table.add_row(finding.what, mark, finding.seen, finding.do)
        Console(file=sys.stdout).print(table)
    if not next(finding for finding in findings if finding.what == "C compiler").found:
        sys.exit(1)
