"""The `springpot` command: subcommands by name, errors as one line and an exit status."""

import importlib
import sys

import click

from springpot.host.output import say
from springpot.runtime_c.errors import SpringpotError

# Command -> module and object. Loaded when used: replaying never loads what only training needs.
_COMMANDS = {
    "doctor": ("doctor_command", "doctor"),
    "demo": ("demo_command", "demo"),
    "record": ("record_command", "record"),
    "import": ("import_command", "import_"),
    "check": ("check_command", "check"),
    "plot": ("plot_command", "plot"),
    "export": ("export_command", "export_"),
    "train": ("train_command", "train"),
    "emit": ("emit_command", "emit_"),
    "build": ("emit_command", "build"),
    "firmware": ("firmware_command", "firmware"),
    "stability": ("stability_command", "stability_"),
    "validate": ("validate_command", "validate_"),
    "run": ("run_command", "run"),
    "bench": ("bench_command", "bench"),
    "report": ("report_command", "report"),
    "reproduce": ("reproduce_command", "reproduce"),
    "material": ("material_command", "material"),
}


class _Commands(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _COMMANDS:
            return None
        module, name = _COMMANDS[cmd_name]
        command = getattr(importlib.import_module(f"springpot.host.{module}"), name)
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
    except SpringpotError as error:
        say(f"springpot: {error}")
        sys.exit(error.exit_status)
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
