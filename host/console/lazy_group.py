"""Groups of commands that are loaded one by one: the list of all loads none."""

import difflib
import importlib
from collections.abc import Mapping
from typing import Any, NamedTuple

import click
from click.shell_completion import CompletionItem


class LazyCommand(NamedTuple):
    """path: "module:object" under host/commands. short_help: the first line of its own help."""

    path: str
    short_help: str


class LazyGroup(click.Group):
    """A group whose commands are imported when they are used."""

    def __init__(
        self, *args: Any, commands_by_name: Mapping[str, LazyCommand], **options: Any
    ) -> None:
        super().__init__(*args, **options)
        self._lazy = commands_by_name

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self._lazy)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self._lazy:
            return None
        module, _, name = self._lazy[cmd_name].path.partition(":")
        command = getattr(importlib.import_module(f"springpot.host.commands.{module}"), name)
        assert isinstance(command, click.Command)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click does, with the name that may be meant where there is none like it."""
        near = difflib.get_close_matches(args[0], self._lazy, 1)
        if near and args[0] not in self._lazy and not ctx.resilient_parsing:
            ctx.fail(f"No such command {args[0]!r} (did you mean {near[0]}?)")
        return super().resolve_command(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Names of commands, without loading one."""
        found = [
            CompletionItem(name, help=item.short_help)
            for name, item in self._lazy.items()
            if name.startswith(incomplete)
        ]
        return [*found, *click.Command.shell_complete(self, ctx, incomplete)]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, found.short_help) for name, found in self._lazy.items()])
