"""Completion in a shell: names of commands without loading them, options, choices."""

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete
from support.run_pages import MAIN

from springpot.host.cli import springpot

SHELLS = ("bash", "zsh", "fish")


def offered(*words: str) -> list[str]:
    complete = ShellComplete(springpot, {}, "springpot", "_SPRINGPOT_COMPLETE")
    return [item.value for item in complete.get_completions(list(words[:-1]), words[-1])]


def test_commands_options_and_choices() -> None:
    assert offered("st") == ["stability", "study"]
    assert offered("study", "s") == ["simulate"]
    assert set(offered("train", "--mo")) == {"--model", "--monotone"}
    assert offered("train", "--model", "rbf") == ["rbf-fd", "rbf-pv"]
    assert offered("completion", "") == list(SHELLS)


def test_names_of_commands_load_none() -> None:
    code = (
        "import sys; from springpot.host.cli import springpot; import click.shell_completion as c;"
        "assert len(c.ShellComplete(springpot, {}, '', '').get_completions([], '')) > 20;"
        "print([m for m in sys.modules if m.startswith(('springpot.host.commands.', 'numpy'))])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")
def test_bash_takes_the_script(tmp_path: Path) -> None:
    program = tmp_path / "springpot"
    program.write_text(f'#!/bin/sh\nexec {shlex.join(MAIN)} "$@"\n')
    program.chmod(0o755)
    ask = (
        'eval "$(springpot completion bash)"; COMP_WORDS=(springpot train --model rf); '
        'COMP_CWORD=3; _springpot_completion springpot; echo "${COMPREPLY[@]}"; '
        "complete -p springpot"
    )
    done = subprocess.run(
        ["bash", "-c", ask], capture_output=True, text=True, check=False,
        env={**os.environ, "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"},
    )  # fmt: skip
    assert done.stdout.splitlines()[0] == "rf-fd rf-history", done.stderr
    assert "-F _springpot_completion springpot" in done.stdout


@pytest.mark.parametrize("shell", SHELLS)
def test_each_shell_has_a_script(shell: str) -> None:
    done = subprocess.run([*MAIN, "completion", shell], capture_output=True, text=True, check=True)
    assert "_SPRINGPOT_COMPLETE" in done.stdout
