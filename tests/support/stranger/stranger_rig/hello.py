"""The command `springpot hello`."""

import click

from springpot.host.console.lazy_group import LazyCommand
from springpot.host.console.output import json_option, print_result

HELLO = LazyCommand("stranger_rig.hello:hello", "Greet an OBJECT.")


@click.command()
@click.argument("object_name", metavar="OBJECT")
@json_option
def hello(object_name: str, as_json: bool) -> None:
    """Greet an OBJECT."""
    print_result({"greeted": object_name}, as_json, {"hello": object_name})
