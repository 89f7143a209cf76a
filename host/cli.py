"""The `springpot` command: subcommands by name, errors as one line and an exit status."""

import io
import sys

import click

from springpot.codegen import errors
from springpot.host.console.lazy_group import LazyCommand, LazyGroup
from springpot.host.console.output import say

# Each is loaded when it is used, none for the list of all: replaying never loads what only
# training needs.
_COMMANDS = {
    "doctor": LazyCommand("doctor:doctor",
        "Show what this machine offers, and what to do where something is missing."),
    "demo": LazyCommand("scenes.demo:demo",
        "Do the whole job on a simulated object: record, train, emit, build, validate, report."),
    "record": LazyCommand("recordings.record:record",
        "Drive a device under force control and write one recording for each profile."),
    "import": LazyCommand("recordings.import_:import_",
        "Turn CSV, MAT, HDF5, Mach-1 text files, CAN logs and journals into recordings."),
    "check": LazyCommand("recordings.check:check_",
        "Report the quality of RECORDINGS (files or folders); refusals end with status 3."),
    "plot": LazyCommand("recordings.plot:plot",
        "Draw RECORDINGS: time series, loops by rate and amplitude, spectra, stiffness and loss."),
    "export": LazyCommand("recordings.export:export_",
        "Write RECORDINGS (files or folders) as files that other programs read."),
    "train": LazyCommand("models.train:train",
        "Fit a model on RECORDINGS (files or folders)."),
    "emit": LazyCommand("scenes.emit:emit_",
        "Emit the C source of a scene, or of a benchmark's pick (keys of --scene override it)."),
    "build": LazyCommand("scenes.emit:build",
        "Build an emitted FOLDER's shared library in the cache; print its path."),
    "firmware": LazyCommand("scenes.firmware:firmware",
        "Build a board's firmware; all its sources lie beside it."),
    "stability": LazyCommand("scenes.stability:stability_",
        "Spectral radius, small-signal maps, and a closed loop with three hands."),
    "validate": LazyCommand("scenes.validate:validate_",
        "Replay recordings through the C of an emitted FOLDER."),
    "run": LazyCommand("scenes.run:run",
        "Render a scene on a device."),
    "place": LazyCommand("devices.place:place",
        "Find the surface: touch it with the tool three times, the Enter key each time."),
    "identify": LazyCommand("devices.identify:identify",
        "Measure a device that nobody holds: mass, friction, delay, sensors. It moves by itself."),
    "bench": LazyCommand("models.bench:bench",
        "Measure every kind and size of model on your recordings; mark the front; pick."),
    "report": LazyCommand("scenes.report:report",
        "Write a self-contained HTML page on FOLDER: a benchmark, or an emitted, validated scene."),
    "page": LazyCommand("scenes.page:page",
        "Write one HTML file in which people press the emitted FOLDERS, in a browser."),
    "reproduce": LazyCommand("models.reproduce:reproduce",
        "Repeat the paper's tables and figures, and say which of its claims hold here."),
    "study": LazyCommand("study.group:study",
        "Does it feel like the object? Plan a study, run it with people, and report."),
    "material": LazyCommand("models.material:material",
        "Material of a MODEL of kind springpot: shear moduli need the tip's size, else stiffness."),
    "completion": LazyCommand("completion:completion",
        "Print the script with which a SHELL completes commands, options and file names."),
}  # fmt: skip

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


@click.group(cls=LazyGroup, commands_by_name=_COMMANDS)
@click.version_option(package_name="springpot")
def springpot() -> None:
    """Recordings of a soft object in; small, fast, checked C that renders its feel out."""


def main() -> None:
    """Entry point: run a command; a refusal is one line on standard error and its exit status."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # File names that are no UTF-8, and letters that the locale lacks, must not stop a run.
            stream.reconfigure(errors="backslashreplace")
    try:
        springpot.main(prog_name="springpot", standalone_mode=False)
    except errors.SpringpotError as error:
        say(f"springpot: {error}")
        sys.exit(exit_status(error))
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else "springpot"
        say(f"springpot: {error.format_message().rstrip('.')}: see `{command} --help`")
        sys.exit(2)
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
