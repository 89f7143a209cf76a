"""Help and completion are quick, and long work says how far it is."""

import json
import subprocess
import sys

LIGHT = {"annotated_types", "click", "rich", "springpot", "typing_extensions"}
ASK_ALL = f"""
import sys
started = set(sys.modules)  # a system's own sitecustomize among them
import io, json
from contextlib import redirect_stdout
import click
from springpot.host.cli import springpot

def heavy():
    loaded = {{name.split(".")[0] for name in set(sys.modules) - started if name[0] != "_"}}
    return sorted(loaded - {LIGHT!r} - sys.stdlib_module_names)

def help_of(*arguments):
    with redirect_stdout(io.StringIO()) as printed:
        springpot.main([*arguments, "--help"], standalone_mode=False)
    return printed.getvalue()

listed = help_of()
asked = {{name: help_of(name) for name in springpot.list_commands(click.Context(springpot))}}
short = {{
    name: springpot.get_command(click.Context(springpot), name).get_short_help_str(1000)
    for name in asked
}}
print(json.dumps([listed, asked, short, heavy()]))
"""


def test_help_loads_nothing_heavy_and_lists_whole_lines() -> None:
    done = subprocess.run([sys.executable, "-c", ASK_ALL], capture_output=True, text=True,
                          check=True)  # fmt: skip
    listed, asked, short, heavy = json.loads(done.stdout)
    assert heavy == []
    assert len(asked) > 12
    words = " ".join(listed.split())
    for name, text in short.items():
        assert f" {name} {text}" in words, f"host/cli.py lists {name} otherwise than its help"
        assert text.rstrip(".") in " ".join(asked[name].split())
