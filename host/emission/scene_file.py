"""Scene files: TOML, checked key by key."""

import dataclasses
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import write_file
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Scene
from springpot.host.console.toml_file import checked_keys, toml_as_json

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


def read_scene(path: Path) -> Scene:
    """Read a scene file. Raises UsageError that names the key, its value and what it may be."""
    return _checked(toml_as_json(path, _MAX_BYTES, "scene file"), str(path))


def scene_from_json(text: str, where: str) -> Scene:
    """Read a scene that `scene_to_json` wrote."""
    return _checked(text, where)


def scene_to_json(scene: Scene) -> str:
    """All keys of the scene, defaults included."""
    return json.dumps(dataclasses.asdict(scene), indent=2, default=_plain_number) + "\n"


def _plain_number(value: object) -> object:
    """A number of numpy as Python's. Raises TypeError for anything else."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{value!r} is no number")


def checked_scene(scene: Scene) -> Scene:
    """A scene that was made in Python, checked as its file would be. Raises UsageError as that."""
    try:
        return _checked(scene_to_json(scene), "scene")
    except TypeError as error:
        raise UsageError(f"scene: {error}: give numbers, strings and booleans") from None


def write_scene(path: Path, scene: Scene) -> None:
    """Write the keys that differ from their defaults, as TOML. Raises UsageError as reading."""
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
    write_file(path, text.replace("\x7f", "\\u007f").encode())


def model_path(scene: Scene, scene_file: Path) -> Path:
    """The scene's model file; a relative path starts at the scene file.

    Raises DataError where it is not there.
    """
    file = scene_file.parent / scene.model
    if not file.exists():
        raise DataError(f"{file}: cannot be read (no such file): `model` of {scene_file} names it")
    return file


def default_scene(model: Model) -> Scene:
    """The scene of a model alone: every key has its default."""
    return Scene(schema=1, name=model.name, model="model.spm")


def _checked(text: str, where: str) -> Scene:
    if "energy" in (json.loads(text).get("guard") or {}):
        raise UsageError(
            f"{where}: guard.energy: the account of energy was removed, because it cut the force "
            "of a hand at rest: delete the key"
        )
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
