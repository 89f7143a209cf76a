"""Help and completion are quick, and long work says how far it is."""

import json
import logging
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete
from support.pages.run_pages import MAIN

from springpot.host.cli import springpot
from springpot.host.console.output import progress_bar

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


def offered(*words: str) -> list[str]:
    complete = ShellComplete(springpot, {}, "springpot", "_SPRINGPOT_COMPLETE")
    return [item.value for item in complete.get_completions(list(words[:-1]), words[-1])]


def test_commands_options_and_choices() -> None:
    assert offered("st") == ["stability", "study"]
    assert offered("study", "r") == ["run", "report"]
    assert set(offered("train", "--mo")) == {"--model"}
    assert offered("train", "--model", "rbf") == ["rbf-fd", "rbf-pv"]


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")
def test_bash_takes_the_script(tmp_path: Path) -> None:
    program = tmp_path / "springpot"
    program.write_text(f'#!/bin/sh\nexec {shlex.join(MAIN)} "$@"\n')
    program.chmod(0o755)
    ask = (
        'eval "$(_SPRINGPOT_COMPLETE=bash_source springpot)"; '
        "COMP_WORDS=(springpot train --model rf); COMP_CWORD=3; "
        '_springpot_completion springpot; echo "${COMPREPLY[@]}"; '
        "complete -p springpot"
    )
    done = subprocess.run(
        ["bash", "-c", ask], capture_output=True, text=True, check=False,
        env={**os.environ, "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"},
    )  # fmt: skip
    assert done.stdout.splitlines()[0] == "rf-fd", done.stderr
    assert "-F _springpot_completion springpot" in done.stdout


def test_the_bar_says_which_candidate_is_fitted_and_how_much_is_left() -> None:
    auto = logging.getLogger("springpot.trainer.selection.auto")
    with progress_bar("fitting auto on 4 recordings") as progress:
        (task,) = progress.tasks
        assert task.total is None
        auto.info("3 of 4: rf-fd", extra={"done": 9, "total": 12})
        assert task.description == "fitting auto on 4 recordings, 3 of 4: rf-fd"
        assert (task.completed, task.total) == (9, 12)
    auto.info("4 of 4: boosted", extra={"done": 12, "total": 12})
    assert task.completed == 9
