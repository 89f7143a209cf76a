"""`springpot doctor`."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console
from rich.table import Table
from rich.text import Text

from springpot.host.console.output import json_option

if TYPE_CHECKING:
    from springpot.host.doctor.machine_check import Diagnosis


@click.command()
@click.option("--device", "url", help="Examine this device in place of the machine.")
@click.option(
    "--scene", type=click.Path(path_type=Path), help="Whose [device] says what the device is."
)
@click.option("--yes", is_flag=True, help="The device may push with one newton for half a second.")
@json_option
def doctor(url: str | None, scene: Path | None, yes: bool, as_json: bool) -> None:
    """Show what this machine offers, and what to do where something is missing.

    With --device: is it reached, armed, sampled, and of the right sign.
    """
    if url is None:
        from springpot.host.doctor.machine_check import examine

        findings = examine()
        essential, status = "C compiler", 1
    else:
        findings = _device_findings(url, scene, yes)
        essential, status = "reached and armed", 5
    if as_json:
        click.echo(json.dumps({"findings": [finding.as_dict() for finding in findings]}))
    else:
        _print(findings)
    if not next(finding for finding in findings if finding.what == essential).found:
        sys.exit(status)
    if url is not None and not all(finding.found for finding in findings):
        sys.exit(1)


def _device_findings(url: str, scene: Path | None, yes: bool) -> "list[Diagnosis]":
    from springpot.codegen.scene import Device
    from springpot.host.doctor.device_check import PUSH_N, PUSH_S, check_device
    from springpot.host.emission.scene_file import read_scene

    keys = Device() if scene is None else read_scene(scene).device
    push = yes or (
        sys.stdin.isatty()
        and click.confirm(
            f"Hold the handle loosely: may {url} push with {PUSH_N:g} N for {PUSH_S:g} s?", err=True
        )
    )
    return check_device(url, keys, push=push)


def _print(findings: "Sequence[Diagnosis]") -> None:
    table = Table("what", "", box=None, pad_edge=False)
    for column in ("seen", "what to do"):
        table.add_column(column, overflow="fold")  # paths are whole
    for finding in findings:
        cells = (finding.what, "ok" if finding.found else "--", finding.seen, finding.do)
        table.add_row(*map(Text, cells))  # text as it is: [cc] is no markup
    Console(file=sys.stdout).print(table)
