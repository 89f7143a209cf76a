"""`springpot doctor`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot.console import json_option, print_json, print_table

if TYPE_CHECKING:
    from springpot.host.wings.doctor.machine_check import Diagnosis


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
        from springpot.host.wings.doctor.machine_check import examine

        findings = examine()
        essential, status = "C compiler", 1
    else:
        findings = _device_findings(url, scene, yes)
        essential, status = "reached and armed", 5
    if as_json:
        print_json({"findings": findings})
    else:
        rows = [(item.what, "ok" if item.found else "--", item.seen, item.do) for item in findings]
        print_table(("what", "", "seen", "what to do"), rows)
    if not next(finding for finding in findings if finding.what == essential).found:
        sys.exit(status)
    if url is not None and not all(finding.found for finding in findings):
        sys.exit(1)


def _device_findings(url: str, scene: Path | None, yes: bool) -> "list[Diagnosis]":
    from springpot import Device, read_scene
    from springpot.console import stopping_on_sigterm
    from springpot.host.wings.doctor.device_check import PUSH_N, PUSH_S, check_device

    keys = Device() if scene is None else read_scene(scene).device
    push = yes or (
        sys.stdin.isatty()
        and click.confirm(
            f"Hold the handle loosely: may {url} push with {PUSH_N:g} N for {PUSH_S:g} s?", err=True
        )
    )
    with stopping_on_sigterm():
        return check_device(url, keys, push=push)
