"""Entry points: what packages add to springpot, springpot itself among them, by group and name.

A package that declares

    [project.entry-points."springpot.devices"]
    still = "my_package.still:STILL"

adds the device still://. Groups: springpot.kinds and springpot.devices.
Nothing of a package is loaded before its group is used.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from traceback import extract_tb
from typing import TypeVar

from springpot.codegen.errors import SpringpotError
from springpot.codegen.types import JsonObject

Entry = TypeVar("Entry")


@cache
def _find_entries(group: str) -> tuple[EntryPoint, ...]:
    """Find a group's entries, springpot's own first: no package takes a name from it."""
    return tuple(sorted(entry_points(group=f"springpot.{group}"), key=lambda one: not _is_own(one)))


def load_entries(group: str, kind: type[Entry] | tuple[type[Entry], ...]) -> dict[str, Entry]:
    """Load all entries of the group springpot.`group`: objects of `kind` by name.

    They are sorted by their attribute `place` if they have one, then by name. An entry of another
    package that cannot be loaded, is not of `kind`, or takes a name that springpot has, is left
    out, and a line on standard error says so once. Raises ModuleNotFoundError if springpot itself
    lacks a package.
    """
    loaded_entries: JsonObject = {}
    kinds = kind if isinstance(kind, tuple) else (kind,)
    for entry in _find_entries(group):
        try:
            loaded = entry.load()
        except Exception as error:
            if _is_own(entry):
                raise  # an extra is missing: the command line says which
            lacks = isinstance(error, ModuleNotFoundError)
            _warn_once(entry, str(error) if lacks else f"{type(error).__name__}: {error}")
            continue
        if not isinstance(loaded, kinds):
            _warn_once(entry, f"is no {' or '.join(one.__name__ for one in kinds)}")
        elif entry.name in loaded_entries:
            _warn_once(entry, "the name is taken")
        else:
            loaded_entries[entry.name] = loaded
    sort_keys = {name: (getattr(one, "place", 100), name) for name, one in loaded_entries.items()}
    return dict(sorted(loaded_entries.items(), key=lambda item: sort_keys[item[0]]))


@contextmanager
def blame_package(what: str, called: object, error: type[SpringpotError]) -> Iterator[None]:
    """Raise a defect of another package's code as `error`: one line that names file and line.

    what: the line begins with it. called: a function or class of that package, or "module:name".
    Pass on what the command line has words for, and every defect of springpot itself.
    """
    try:
        yield
    except (SpringpotError, OSError, ModuleNotFoundError):
        raise
    except Exception as defect:
        module = called.partition(":")[0] if isinstance(called, str) else called.__module__
        if module.partition(".")[0] == "springpot":
            raise
        file = getattr(sys.modules.get(module), "__file__", None)
        lines = [at.lineno for at in extract_tb(defect.__traceback__) if at.filename == file]
        location = f", {Path(file).name} line {lines[-1]}" if file and lines else ""
        raise error(
            f"{what}: {type(defect).__name__}: {defect} ({module}{location}): correct or uninstall "
            "that package"
        ) from defect


def _is_own(entry: EntryPoint) -> bool:
    return entry.module.partition(".")[0] == "springpot"


@cache
def _warn_once(entry: EntryPoint, why: str) -> None:
    """Say once that an entry is left out; another package's defect ends no command of springpot."""
    package = f" of {entry.dist.name}" if entry.dist else ""
    print(
        f"springpot: {entry.name!r}{package} ({entry.value}) is left out: {why}: correct or "
        "uninstall that package",
        file=sys.stderr,
    )
