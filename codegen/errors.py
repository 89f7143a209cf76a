"""Errors that a user can act on. Each message is one line: what, where, what to do."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import ClassVar

_MAX_LETTERS = 2000
_COMMAND = re.compile(
    r"`springpot (bench|check|emit|import|record|stability|train|validate)\b[^`]*`"
)
_OPTION = re.compile(  # not in the middle of a file's name
    r"(?<![\w.\-/])--(?!reload)([a-z-]*[a-z])"
    r"(?:[= ]('[^']*'|-?\d[\w.]*|[^\s;]*[=:][^\s;]*[^\s;,.:)]"
    r"|-?[A-Z][A-Z,_]*\b|auto|first|min|comma|paper|recursive|rf-fd|hammerstein|springpot))?"
)
# What Python names otherwise than by underscores, and what a command alone has.
_ARGUMENTS = {
    "map": "columns", "out": "folder", "validate": "validation", "recording": "recordings",
    "centers": "n_centers", "max-depth-mm": "max_depth_m", "place": "place_m",
    "align": "align=True",
}  # fmt: skip
_OF_COMMANDS = ("dask", "find-surface", "fit", "force", "max-speed-mps", "target")


def in_python(text: str) -> str:
    """Name arguments and calls where a message names options, unless a command prints it.

    >>> in_python("import with --contact-force auto, or leave --zero out")
    'import with contact_force="auto", or leave zero out'
    """
    if SpringpotError.in_command:
        return text
    names = {"check": "check_recordings", "import": "import_recordings"}
    calls = _COMMAND.sub(lambda command: f"springpot.{names.get(command[1], command[1])}()", text)
    return _OPTION.sub(_argument, calls)


def _argument(option: re.Match[str]) -> str:
    """Return a command's option, as a message names it, in the words of a call: `smooth_s=0.1`."""
    name, value = option.groups()
    if name in _OF_COMMANDS:
        return f"{option[0]} on the command line"
    if value is None:
        return _ARGUMENTS.get(name, name.replace("-", "_"))
    kind = "kind" if name == "model" else name.replace("-", "_")
    given = value if value[0] in "'-0123456789" or value.isupper() else f'"{value}"'
    return f"{_ARGUMENTS.get(name, kind)}={given}"


class SpringpotError(Exception):
    """Base of all errors shown to a user; host/cli.py maps each to an exit status.

    >>> issubclass(DataError, SpringpotError), issubclass(DataError, ValueError)
    (True, True)
    """

    in_command: ClassVar[bool] = False  # options are named as a terminal has them

    def __str__(self) -> str:
        """One printable line, whatever a file holds that is quoted: terminals obey some bytes."""
        text = in_python(super().__str__())
        if len(text) > _MAX_LETTERS:
            text = f"{text[: _MAX_LETTERS - 500]} ... {text[-490:]}"
        return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


# Of packages that an extra brings, or that come with one of its.
EXTRAS = {
    "sklearn": "train", "scipy": "train", "joblib": "train", "matplotlib": "report", "can": "can",
    "m2cgen": "m2cgen", "distributed": "scale", "dask": "scale", "statsmodels": "study",
    "pandas": "study",
}  # fmt: skip


def missing_package_line(error: ModuleNotFoundError) -> str:
    """Say what to install. pip takes the springpot that is installed, from an index or a folder.

    >>> missing_package_line(ModuleNotFoundError(name="scipy.signal"))
    "scipy is not installed: pip install 'springpot[train]'"
    """
    package = (error.name or "").split(".")[0]
    wanted = f"'springpot[{EXTRAS[package]}]'" if package in EXTRAS else package
    return f"{package} is not installed: pip install {wanted}"


@contextmanager
def naming_missing_packages() -> Iterator[None]:
    """Raise UsageError, which is one line, where a package of an extra is not installed."""
    try:
        yield
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] not in EXTRAS:
            raise
        raise UsageError(missing_package_line(error)) from None


class UsageError(SpringpotError, ValueError):
    """A wrong option, argument, scene key or combination of them.

    >>> train([])
    Traceback (most recent call last):
    springpot.codegen.errors.UsageError: no recordings: give at least one
    """


class DataError(SpringpotError, ValueError):
    """A recording or model file that cannot be used as it is.

    >>> Recording("a", [0, 14], [0, 1], 1e-3)
    Traceback (most recent call last):
    springpot.codegen.errors.DataError: a: position_m spans 14 m: are these mm? ...
    """


class BudgetError(SpringpotError):
    """The emitted C does not fit the scene's flash, RAM or time.

    >>> emit("tiny", model=model, scene=Scene(1, "a", "a.spm", budget=Budget(ram_bytes=1)))
    Traceback (most recent call last):
    springpot.codegen.errors.BudgetError: RAM: ...
    """


class DeviceError(SpringpotError):
    """A device that cannot be opened, or that failed while in use.

    >>> Session("c", "serial:///dev/none").__enter__()
    Traceback (most recent call last):
    springpot.codegen.errors.DeviceError: ...
    """


class UnsafeError(SpringpotError):
    """A scene with an unstable loop: refused.

    >>> emit("stiff", model=model, scene=Scene(1, "a", "a.spm", coupling=Coupling("tool", 1e6)))
    Traceback (most recent call last):
    springpot.codegen.errors.UnsafeError: ...
    """


class MismatchError(SpringpotError):
    """C and its numpy reference gave different bits.

    >>> validate("c", recordings).mismatches  # else `springpot validate` ends with this error
    0
    """
