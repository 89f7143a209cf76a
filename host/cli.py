"""The `springpot` command: subcommands by name, errors as one line and an exit status."""

import importlib
import sys

import click

from springpot.codegen import errors
from springpot.host.console.output import say

# Command -> module and object. Loaded when used: replaying never loads what only training needs.
_COMMANDS = {
    "doctor": ("doctor", "doctor"),
    "demo": ("scenes.demo", "demo"),
    "record": ("recordings.record", "record"),
    "import": ("recordings.import_", "import_"),
    "check": ("recordings.check", "check"),
    "plot": ("recordings.plot", "plot"),
    "export": ("recordings.export", "export_"),
    "train": ("models.train", "train"),
    "emit": ("scenes.emit", "emit_"),
    "build": ("scenes.emit", "build"),
    "firmware": ("scenes.firmware", "firmware"),
    "stability": ("scenes.stability", "stability_"),
    "validate": ("scenes.validate", "validate_"),
    "run": ("scenes.run", "run"),
    "bench": ("models.bench", "bench"),
    "report": ("scenes.report", "report"),
    "reproduce": ("models.reproduce", "reproduce"),
    "material": ("models.material", "material"),
}

_EXIT_STATUS: dict[type[Exception], int] = {
    errors.UsageError: 2,
    errors.DataError: 3,
    errors.BudgetError: 4,
    errors.DeviceError: 5,
    errors.UnsafeError: 6,
    errors.MismatchError: 7,
}


def exit_status(error: errors.SpringpotError) -> int:
    """What an error ends the command line with; 1 for a check that failed."""
    return next((_EXIT_STATUS[kind] for kind in type(error).__mro__ if kind in _EXIT_STATUS), 1)


class _Commands(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _COMMANDS:
            return None
        module, name = _COMMANDS[cmd_name]
        command = getattr(importlib.import_module(f"springpot.host.commands.{module}"), name)
        assert isinstance(command, click.Command)
        return command


@click.group(cls=_Commands)
@click.version_option(package_name="springpot")
def springpot() -> None:
    """Recordings of a soft object in; small, fast, checked C that renders its feel out."""


def main() -> None:
    """Entry point: run a command; a refusal is one line on standard error and its exit status."""
    try:
        springpot.main(standalone_mode=False)
    except errors.SpringpotError as error:
        say(f"springpot: {error}")
        sys.exit(exit_status(error))
    except click.ClickException as error:
        say(f"springpot: {error.format_message()}")
        sys.exit(2)
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        say(f"springpot: {place}{error.strerror or error}: choose another place, or free this one")
        sys.exit(2)
    except click.exceptions.Abort:
        say("springpot: interrupted")
        sys.exit(130)
    except click.exceptions.Exit as stop:
        sys.exit(stop.exit_code)
    except ModuleNotFoundError as error:
        package = (error.name or "").split(".")[0]
        if package == "springpot":
            raise
        extras = "springpot[train,report,can,m2cgen]"
        say(f"springpot: {package} is not installed: `pip install '{extras}'`")
        sys.exit(2)
