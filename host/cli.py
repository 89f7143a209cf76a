"""The `springpot` command: subcommands by name, errors as one line and an exit status."""

import atexit
import io
import signal
import sys
from types import FrameType

import click

from springpot.codegen import errors
from springpot.host.commands import COMMANDS
from springpot.host.options import CommandGroup
from springpot.host.output import describe_os_error, notices_printed, print_line

_EXIT_STATUS: dict[type[Exception], int] = {
    errors.UsageError: 2,
    errors.DataError: 3,
    errors.BudgetError: 4,
    errors.DeviceError: 5,
    errors.UnsafeError: 6,
    errors.MismatchError: 7,
}


def exit_status(error: errors.SpringpotError) -> int:
    """Return the exit status of an error; 1 for a check that failed."""
    return next((_EXIT_STATUS[kind] for kind in type(error).__mro__ if kind in _EXIT_STATUS), 1)


@click.group(
    cls=CommandGroup, table=COMMANDS, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(package_name="springpot")
def springpot() -> None:
    """Recordings of a soft object in; small, fast, checked C that renders its feel out."""
    click.get_current_context().with_resource(notices_printed())


def main() -> None:
    """Entry point: run a command; a refusal is one line on standard error and its exit status."""
    # Once a command is done its status stands, however long Python takes to end.
    errors.SpringpotError.in_command = True
    atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
    interrupts = _counted_interrupts()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # File names that are no UTF-8, and letters that the locale lacks, must not stop a run.
            stream.reconfigure(errors="backslashreplace")
    try:
        springpot.main(prog_name="springpot", standalone_mode=False)
    except errors.SpringpotError as error:
        print_line(f"springpot: {error}")
        sys.exit(exit_status(error))
    except click.UsageError as error:
        print_line(_usage_text(error))
        sys.exit(2)
    except click.ClickException as error:
        print_line(f"springpot: {error.format_message()}")
        sys.exit(2)
    except OSError as error:
        print_line(f"springpot: {describe_os_error(error)}")
        sys.exit(2)
    except click.exceptions.Abort:
        print_line("springpot: interrupted")
        sys.exit(130)
    except click.exceptions.Exit as stop:
        sys.exit(stop.exit_code)
    except MemoryError:
        print_line("springpot: not enough memory: give fewer or shorter recordings at a time")
        sys.exit(2)
    except ModuleNotFoundError as error:
        print_line(f"springpot: {_what_is_missing(error)}")
        sys.exit(2)
    except (ImportError, SystemError):
        if not interrupts:
            raise
        # A compiled module that is being imported makes another error of Ctrl-C.
        print_line("springpot: interrupted")
        sys.exit(130)


def _usage_text(error: click.UsageError) -> str:
    """Return one line; the whole help of a group that was called without a command."""
    if isinstance(error, click.exceptions.NoArgsIsHelpError):
        return error.format_message()
    command = error.ctx.command_path if error.ctx else "springpot"
    line = " ".join(error.format_message().split()).rstrip(".")
    return f"springpot: {line}: see `{command} --help`"


def _counted_interrupts() -> list[int]:
    """Grows with each Ctrl-C, which interrupts as before."""
    interrupts: list[int] = []

    def on_interrupt(number: int, frame: FrameType | None) -> None:
        interrupts.append(number)
        signal.default_int_handler(number, frame)

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, on_interrupt)
    return interrupts


def _what_is_missing(error: ModuleNotFoundError) -> str:
    """Raises the error if the module is one of springpot's own."""
    package = (error.name or "").split(".")[0]
    if package == "springpot":
        raise error
    if package in sys.stdlib_module_names:  # fcntl, termios, resource
        return f"this system's Python has no {package}: use Linux, or WSL2 on Windows"
    return errors.missing_package_line(error)
