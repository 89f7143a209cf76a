"""Types of command-line options that click does not bring."""

import math
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import click

_Command = Callable[..., Any]


class FiniteRange(click.FloatRange):
    """A number in a range; NaN and infinities are none."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number, or fail with the option's name."""
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number", param, ctx)
        return number

    def _describe_range(self) -> str:
        """What help shows; nothing of any number."""
        return "any" if self.min is None and self.max is None else super()._describe_range()


PATH = click.Path(path_type=Path)
SEED = click.IntRange(0, 2**32 - 1)
POSITIVE = FiniteRange(0, min_open=True)
NOT_NEGATIVE = FiniteRange(0)


def recordings_given(help_text: str) -> Callable[[_Command], _Command]:
    """Take recordings behind a command's other arguments or by --recording, as `recordings`."""

    def decorate(command: _Command) -> _Command:
        @wraps(command)
        def merged(*, recordings: tuple[str, ...], named: tuple[str, ...], **others: Any) -> Any:
            if not recordings and not named:
                raise click.UsageError("Missing recordings: give files or folders of them")
            return command(recordings=(*recordings, *named), **others)

        by_place = click.argument("recordings", nargs=-1, type=click.Path(), metavar="REC...")
        by_name = click.option(
            "--recording", "named", multiple=True, type=click.Path(), metavar="REC",
            help=f"{help_text}; the same as REC. May be repeated.",
        )  # fmt: skip
        return by_place(by_name(merged))

    return decorate
