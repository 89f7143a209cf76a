"""Groups of commands that are loaded one by one: the list of all loads none."""

import difflib
import importlib
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import click


@dataclass(frozen=True)
class LazyCommand:
    """path: "module:function". short_help: in lists, by default the first line of its help."""

    path: str
    short_help: str = ""

    def load(self) -> click.Command:
        """Import the command."""
        module, _, name = self.path.partition(":")
        command = getattr(importlib.import_module(module), name)
        assert isinstance(command, click.Command)
        return command

    def line(self) -> str:
        """Return the short help; if none was given, out of the source, importing nothing."""
        if self.short_help:
            return self.short_help
        module, _, name = self.path.partition(":")
        package = module.rpartition(".")[0]
        while package and package not in sys.modules:
            package = package.rpartition(".")[0]
        below = module.removeprefix(package).strip(".").replace(".", "/")
        source = files(package or __package__) / f"{below}.py"
        text = source.read_text(encoding="utf-8") if source.is_file() else ""
        found = re.search(rf'^def {name}\(.*?^    """(.*?)(?:"""|$)', text, re.M | re.S)
        return found[1] if found else self.load().get_short_help_str(80)


class LazyGroup(click.Group):
    """A group whose commands, by name, are imported when they are used."""

    def __init__(
        self, *args: Any, table: Mapping[str, LazyCommand | click.Command], **options: Any
    ) -> None:
        super().__init__(*args, **options)
        self._table = table

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self._table)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        found = self._table.get(cmd_name)
        return found.load() if isinstance(found, LazyCommand) else found

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Resolve as click does; refuse empty words, and name the nearest of an unknown command."""
        if not ctx.resilient_parsing:
            _refuse_empty(ctx, args)
        near = difflib.get_close_matches(args[0], self._table, 1)
        if near and args[0] not in self._table and not ctx.resilient_parsing:
            ctx.fail(f"No such command {args[0]!r} (did you mean {near[0]}?)")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(self._short_helps())

    def _short_helps(self) -> list[tuple[str, str]]:
        return [
            (name, one.line() if isinstance(one, LazyCommand) else one.get_short_help_str(80))
            for name, one in self._table.items()
        ]


def _refuse_empty(ctx: click.Context, args: list[str]) -> None:
    """Fail where a word is empty: no command means anything by it, and "" as a path is ".".

    A shell variable that is not set makes one, as in `springpot import "$FOLDER"`.
    """
    for number, word in enumerate(args):
        option, equals, value = word.partition("=") if word.startswith("--") else ("", "", word)
        if value or (option and not equals):
            continue
        if not option:
            before = args[number - 1] if number else ""
            option = before if before.startswith("--") else f"argument {number}"
        ctx.fail(f"{args[0]}: {option} is empty (a variable that is not set?): give a value")
