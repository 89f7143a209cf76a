"""Scene files, and other TOML files of users, checked key by key against a dataclass."""

import dataclasses
import json
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import TypeAdapter, ValidationError

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import parse_path, read_bounded, write_file
from springpot.codegen.scene import Scene
from springpot.trainer.recordings.recording_file import File

T = TypeVar("T")
_NO_SUCH_KEY = ("unexpected_keyword_argument", "extra_forbidden")
_ADAPTER = TypeAdapter(Scene)
_EXAMPLE = Scene(schema=1, name="example", model="model.spm")
_MAX_BYTES = 1 << 14  # a page or five; the TOML reader takes the square of a dotted key
_FIRST = ("schema", "name", "model")  # keys without a section, and without a default
# Words and headers of C: a file or name of ours would hide them.
_TAKEN = frozenset(
    """auto break case char const continue default do double else enum extern float for goto if
    inline int long main register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while assert complex ctype errno fenv inttypes iso646 limits locale
    math setjmp signal stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn
    string tgmath threads time uchar wchar wctype""".split()  # noqa: SIM905
)
_IDENTIFIER = re.compile(r"[a-z][a-z0-9_]{0,30}")


def toml_as_json(path: Path, max_bytes: int, what: str) -> str:
    """Return the file's content as JSON. Raises UsageError for what is none; what: "scene file"."""
    try:
        return json.dumps(tomllib.loads(read_bounded(path, max_bytes, what).decode()))
    except OSError as error:
        raise UsageError(f"{path}: cannot be read ({error.strerror}): give a {what}") from None
    except (ValueError, TypeError, RecursionError) as error:  # DataError too
        why = str(error).splitlines()[0]
        raise UsageError(
            f"{path}: not a {what} ({why}): give TOML in UTF-8; pass a model with --model"
        ) from None


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
            fault = "missing: add this key"
        elif first["type"] in _NO_SUCH_KEY:
            here = known(place[:-1])
            of = [f"[{name}]" for name in known(()) if place[-1] in known((name,))]
            elsewhere = f"it is one of {' and of '.join(of)}; " if of else ""
            fault = f"no such key: {elsewhere}known here are {', '.join(here)}"
        elif first["type"] == "value_error":  # of a whole section: no one value is wrong
            fault = first["msg"].removeprefix("Value error, ")
        else:
            fault = f"{first['msg']} (found {first['input']!r})"
        key = f"{'.'.join(map(str, place))}: " if place else ""
        raise UsageError(f"{where}: {key}{fault}") from None


def read_scene(path: File) -> Scene:
    """Read a scene file. Raises UsageError that names the key, its value and what it may be.

    >>> read_scene("scene.toml").name
    'pad'
    """
    return scene_from_json(toml_as_json(parse_path(path), _MAX_BYTES, "scene file"), str(path))


def scene_to_json(scene: Scene) -> str:
    """Return all keys of the scene, defaults included."""
    return json.dumps(dataclasses.asdict(scene), indent=2, default=np.generic.item) + "\n"


def checked_scene(scene: Scene) -> Scene:
    """A scene that was made in Python, checked as its file would be. Raises UsageError as that."""
    try:
        return scene_from_json(scene_to_json(scene), "scene")
    except TypeError as error:
        raise UsageError(f"scene: {error}: give numbers, strings and booleans") from None


def write_scene(path: File, scene: Scene) -> None:
    """Write the keys of a scene that differ from their defaults, as TOML.

    The scene's `model`, where it is no absolute path, counts from the file's folder.
    Raises UsageError as `read_scene`.

    >>> write_scene("scene.toml", Scene(1, "pad", "model.spm"))
    >>> read_scene("scene.toml").model
    'model.spm'
    """
    keys = dataclasses.asdict(checked_scene(scene))
    usual = dataclasses.asdict(_EXAMPLE)
    sections = {"": {name: keys.pop(name) for name in _FIRST}} | {
        name: {key: value for key, value in section.items() if value != usual[name][key]}
        for name, section in keys.items()
    }
    lines = []
    for name, section in sections.items():
        lines += ["", f"[{name}]"] if name and section else []
        # JSON writes numbers, booleans and quoted text as TOML does, but for one letter.
        lines += [
            f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in section.items()
        ]
    text = "".join(f"{line}\n" for line in lines)
    write_file(parse_path(path), text.replace("\x7f", "\\u007f").encode())


def model_path(scene: Scene, scene_file: Path) -> Path:
    """Return the scene's model file; a relative path starts at the scene file.

    Raises DataError where it is not there.
    """
    file = scene_file.parent / scene.model
    if not file.exists():
        raise DataError(f"{file}: cannot be read (no such file): `model` of {scene_file} names it")
    return file


def scene_from_json(text: str, where: str) -> Scene:
    """Read a scene that `scene_to_json` wrote. Raises UsageError as `read_scene`."""
    scene = checked_keys(_ADAPTER, text, where, _known_keys)
    prefix = scene.runtime.prefix
    if not _IDENTIFIER.fullmatch(prefix) or prefix in _TAKEN or prefix.startswith("sp_"):
        raise UsageError(
            f"{where}: runtime.prefix: {prefix!r} cannot begin C names: use lower-case letters, "
            "digits and underscores, no word or header of C, and not sp_..."
        )
    unfit = [mark for mark in ("/*", "*/", "??", "\\", "\0") if mark in scene.name]
    if not scene.name.isprintable() or not scene.name or unfit:
        raise UsageError(
            f"{where}: name: {scene.name!r}: give a printable name without comment marks, ?? or \\"
        )
    if "\0" in scene.model:
        raise UsageError(f"{where}: model: {scene.model!r}: give the path of a model file")
    if scene.device.delay_samples and scene.device.delay_s is not None:
        raise UsageError(f"{where}: device.delay_s: beside delay_samples: state one of the two")
    return scene


def _known_keys(place: tuple[Any, ...]) -> list[str]:
    section = getattr(_EXAMPLE, str(place[0]), None) if place else None
    keys_of = section if dataclasses.is_dataclass(section) else _EXAMPLE
    return [field.name for field in dataclasses.fields(keys_of)]
