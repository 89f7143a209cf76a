"""Scene files: TOML, checked key by key."""

import dataclasses
import json
import re
import tomllib
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from springpot.codegen.atomic_write import write_file
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.regular_file import read_bounded
from springpot.codegen.scene import Scene

_ADAPTER = TypeAdapter(Scene)
_EXAMPLE = Scene(schema=1, name="example", model="model.spm")
_MAX_BYTES = 1 << 14  # a page or five; the TOML reader takes the square of a dotted key
_FIRST = ("schema", "name", "model")  # keys without a section, and without a default
# Words of C and of the headers that the emitted sources include: a file or name of ours would hide
# them.
_TAKEN = frozenset(
    """auto break case char const continue default do double else enum extern float for goto if
    inline int long main register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while math stddef stdint stdio string""".split()  # noqa: SIM905
)
_IDENTIFIER = re.compile(r"[a-z][a-z0-9_]{0,30}")


def read_scene(path: Path) -> Scene:
    """Read a scene file. Raises UsageError that names the key, its value and what it may be."""
    try:
        text = read_bounded(path, _MAX_BYTES).decode()
        content = json.dumps(tomllib.loads(text))
    except OSError as error:
        raise UsageError(f"{path}: cannot be read ({error.strerror}): give a scene file") from None
    except DataError as error:
        raise UsageError(str(error)) from None
    except (ValueError, TypeError, RecursionError) as error:
        raise UsageError(f"{path}: not a scene: {str(error).splitlines()[0]}") from None
    return _checked(content, str(path))


def scene_from_json(text: str, where: str) -> Scene:
    """Read a scene that `scene_to_json` wrote."""
    return _checked(text, where)


def scene_to_json(scene: Scene) -> str:
    """All keys of the scene, defaults included."""
    return json.dumps(dataclasses.asdict(scene), indent=2) + "\n"


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
        lines += [f"{key} = {_toml(value)}" for key, value in section.items()]
    write_file(path, "".join(f"{line}\n" for line in lines).encode())


def model_path(scene: Scene, scene_file: Path) -> Path:
    """The scene's model file; a relative path starts at the scene file."""
    return scene_file.parent / scene.model


def _checked(text: str, where: str) -> Scene:
    try:
        scene = _ADAPTER.validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        found = _message(first["type"], key) or f"{first['msg']} (found {first['input']!r})"
        raise UsageError(f"{where}: {key}: {found}") from None
    prefix = scene.runtime.prefix
    if not _IDENTIFIER.fullmatch(prefix) or prefix in _TAKEN or prefix.startswith("sp_"):
        raise UsageError(
            f"{where}: runtime.prefix: {prefix!r} cannot begin C names: use lower-case letters, "
            "digits and underscores, no word of C, and not sp_..."
        )
    unfit = [mark for mark in ("/*", "*/", "??", "\\", "\0") if mark in scene.name]
    if not scene.name.isprintable() or not scene.name or unfit:
        raise UsageError(
            f"{where}: name: {scene.name!r}: give a printable name without comment marks, ?? or \\"
        )
    if "\0" in scene.model:
        raise UsageError(f"{where}: model: {scene.model!r}: give the path of a model file")
    return scene


def _toml(value: str | float) -> str:
    """A value of a key; JSON writes numbers, booleans and quoted text as TOML does."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _message(kind: str, key: str) -> str | None:
    """What to do about a missing or unknown key."""
    if kind == "missing":
        return "missing: add this key"
    if kind in {"unexpected_keyword_argument", "extra_forbidden"}:
        section = key.rpartition(".")[0]
        place = getattr(_EXAMPLE, section, None) if section else _EXAMPLE
        known = [field.name for field in dataclasses.fields(place or _EXAMPLE)]
        return f"no such key: known here are {', '.join(known)}"
    return None
