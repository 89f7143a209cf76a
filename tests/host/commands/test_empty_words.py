"""An empty word, as of a shell variable that is not set, is refused and not taken for "."."""

from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from support.in_process import spring

from springpot.host.cli import springpot as command_line


def commands(group: click.Group, above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for name in group.list_commands(click.Context(group)):
        command = group.get_command(click.Context(group), name)
        if isinstance(command, click.Group):
            yield from commands(command, (*above, name))
            continue
        for one in command.params if command else ():
            if isinstance(one, click.Argument):
                yield (*above, name, "")
            elif isinstance(one, click.Option) and not one.is_flag:
                yield (*above, name, one.opts[0], "")
                yield (*above, name, f"{one.opts[0]}=")


def test_no_command_takes_an_empty_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    given = list(commands(command_line))
    assert ("import", "") in given
    assert ("study", "plan", "--out=") in given
    for words in given:
        done = spring(*words)
        assert done.returncode == 2, words
        assert "is empty" in done.stderr, done.stderr
        assert done.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())
