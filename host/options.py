"""Types of options that click does not bring, and groups of commands that load when used."""

import difflib
import math
import re
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import click

_Command = Callable[..., Any]
PATH = click.Path(path_type=Path)
SEED = click.IntRange(0, 2**32 - 1)
recordings_argument = click.argument("recordings", nargs=-1, required=True, type=click.Path())
device_option = click.option("--device", "url", required=True, help="Such as sim://ecoflex-00-30.")
scene_or_folder_option = click.option(
    "--scene", type=PATH, required=True, help="Scene file, or a folder that `springpot emit` wrote."
)


class FiniteRange(click.FloatRange):
    """A number in a range; NaN and infinities are none."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number, or fail with the option's name."""
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number", param, ctx)
        return number

    def _describe_range(self) -> str:
        """Return the range that the help shows; nothing if any number is allowed."""
        return "any" if self.min is None and self.max is None else super()._describe_range()


POSITIVE = FiniteRange(0, min_open=True)
NOT_NEGATIVE = FiniteRange(0)


def describe_field(described: object, name: str) -> str:
    """Return the sentence of a docstring's list, "name: text" each, as the help of an option.

    >>> describe_field(springpot.train, "leaf")
    'How many rows the smallest leaf of a tree holds.'
    """
    listed = re.split(r"^ *((?:\w+, )*\w+): ", described.__doc__ or "", flags=re.M)
    text = next((text for names, text in zip(listed[1::2], listed[2::2], strict=True)
                 if name in names.split(", ")), "")  # fmt: skip
    text = " ".join(re.split("Raises |>>>", text)[0].split()).replace("None:", "default:")
    return text[:1].upper() + text[1:]


def field_option(
    settings: type, name: str, kind: click.ParamType[Any] | None, described: object = None
) -> Callable[[_Command], _Command]:
    """Make the option of a field of a settings dataclass, with its name and default.

    kind None: a flag. described: whose docstring describes the field, by default the dataclass's.
    """
    default, help_text = getattr(settings, name), describe_field(described or settings, name)
    return click.option(
        f"--{name.replace('_', '-')}", type=kind, is_flag=kind is None, default=default,
        show_default=default is not None and kind is not None, help=help_text,
    )  # fmt: skip


def scene_options(command: _Command) -> _Command:
    """Take a scene, a model, or both, as `scene_file` and `model_file`."""
    by_scene = click.option(
        "--scene", "scene_file", type=PATH, help="Scene file; default: every key has its default."
    )
    by_model = click.option(
        "--model", "model_file", type=PATH, help="Model file; default: the scene's."
    )
    return by_scene(by_model(command))


def recordings_option(flag: str, name: str, help_text: str) -> Callable[[_Command], _Command]:
    """Take recordings and folders of them, one each time that the option is given."""
    return click.option(
        flag, name, multiple=True, type=click.Path(), metavar="REC",
        help=f"{help_text}; may be repeated.",
    )  # fmt: skip


def recordings_given(command: _Command) -> _Command:
    """Take recordings behind a command's other arguments or by --recording, as `recordings`."""

    @wraps(command)
    def merged(*, recordings: tuple[str, ...], named: tuple[str, ...], **others: Any) -> Any:
        if not recordings and not named:
            raise click.UsageError("Missing recordings: give files or folders of them")
        return command(recordings=(*recordings, *named), **others)

    by_place = click.argument("recordings", nargs=-1, type=click.Path(), metavar="REC...")
    by_name = recordings_option("--recording", "named", "Recording or folder, as REC")
    return by_place(by_name(merged))


class CommandGroup(click.Group):
    """A group of commands, each "module:function" by its name."""

    def __init__(self, *args: Any, table: Mapping[str, str], **options: Any) -> None:
        super().__init__(*args, **options)
        self._table = table

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self._table)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        command = resolve_name(self._table[cmd_name]) if cmd_name in self._table else None
        assert command is None or isinstance(command, click.Command)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Resolve as click does; refuse empty words, and name the nearest of an unknown command."""
        if ctx.resilient_parsing:
            return super().resolve_command(ctx, args)
        if any(word == "" or (word[:2] == "--" and word[-1] == "=") for word in args):
            ctx.fail(f"{args[0]}: an argument is empty (a variable that is not set?): give a value")
        near = difflib.get_close_matches(args[0], self._table, 1)
        if near and args[0] not in self._table:
            ctx.fail(f"No such command {args[0]!r} (did you mean {near[0]}?)")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands as click does, each with the whole first line of its help."""
        named = {name: self.get_command(ctx, name) for name in self._table}
        with formatter.section("Commands"):
            formatter.write_dl(
                [(name, one.get_short_help_str(100)) for name, one in named.items() if one]
            )
