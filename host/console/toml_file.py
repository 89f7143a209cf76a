"""TOML files of users, checked key by key against a dataclass."""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import read_bounded
from springpot.codegen.model.model_file import MODEL_SUFFIX

T = TypeVar("T")
_NO_SUCH_KEY = "unexpected_keyword_argument"


def toml_as_json(path: Path, max_bytes: int, what: str) -> str:
    """The file's content as JSON. Raises UsageError for what is none; what: "scene file"."""
    try:
        return json.dumps(tomllib.loads(read_bounded(path, max_bytes, what).decode()))
    except OSError as error:
        raise UsageError(f"{path}: cannot be read ({error.strerror}): give a {what}") from None
    except DataError as error:
        raise UsageError(f"{error}, which is text: {_meant(path, 'give its TOML')}") from None
    except UnicodeDecodeError:
        meant = _meant(path, "save it as UTF-8")
        raise UsageError(f"{path}: not a {what}, which is text: {meant}") from None
    except (ValueError, TypeError, RecursionError) as error:
        raise UsageError(f"{path}: not a {what}: {str(error).splitlines()[0]}") from None


def _meant(path: Path, else_do: str) -> str:
    """What to do with a file that is no text."""
    model = "it is a model, give --model or write a scene that names it"
    return model if path.suffix == MODEL_SUFFIX else else_do


def checked_keys(
    adapter: TypeAdapter[T], text: str, where: str, known: Callable[[tuple[Any, ...]], list[str]]
) -> T:
    """Make the dataclass of JSON. Raises UsageError that names the key, and what it may be.

    known: names of the keys of the section that a place in the file lies in, () of the whole file.
    """
    try:
        return adapter.validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        place = first["loc"]
        if first["type"] == "missing":
            found = "missing: add this key"
        elif first["type"] == _NO_SUCH_KEY:
            here = known(place[:-1])
            of = [f"[{name}]" for name in known(()) if place[-1] in known((name,))]
            elsewhere = f"it is one of {' and of '.join(of)}; " if of else ""
            found = f"no such key: {elsewhere}known here are {', '.join(here)}"
        else:
            found = f"{first['msg']} (found {first['input']!r})"
        raise UsageError(f"{where}: {'.'.join(map(str, place))}: {found}") from None
