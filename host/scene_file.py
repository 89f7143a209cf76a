"""Scene files: TOML, checked key by key."""

import dataclasses
import json
import re
import tomllib
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from springpot.codegen.scene import Scene
from springpot.runtime_c.errors import UsageError

_ADAPTER = TypeAdapter(Scene)
_IDENTIFIER = re.compile(r"[a-z][a-z0-9_]{0,30}")


def read_scene(path: Path) -> Scene:
    """Read a scene file. Raises UsageError that names the key, its value and what it may be."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{path}: cannot be read ({error.strerror})") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: not TOML: {error}") from None
    return _checked(content, str(path))


def scene_from_json(text: str, where: str) -> Scene:
    """Read a scene that `scene_to_json` wrote."""
    return _checked(json.loads(text), where)


def scene_to_json(scene: Scene) -> str:
    """All keys of the scene, defaults included."""
    return json.dumps(dataclasses.asdict(scene), indent=2) + "\n"


def model_path(scene: Scene, scene_file: Path) -> Path:
    """The scene's model file; a relative path starts at the scene file."""
    return scene_file.parent / scene.model


def _checked(content: object, where: str) -> Scene:
    try:
        scene = _ADAPTER.validate_python(content)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        found = "" if first["type"] == "missing" else f" (found {first['input']!r})"
        raise UsageError(f"{where}: {key}: {first['msg']}{found}") from None
    if not _IDENTIFIER.fullmatch(scene.runtime.prefix):
        raise UsageError(
            f"{where}: runtime.prefix: {scene.runtime.prefix!r} cannot begin C names: "
            "use lower-case letters, digits and underscores"
        )
    if not scene.name.isprintable() or "*/" in scene.name or not scene.name:
        raise UsageError(f"{where}: name: {scene.name!r}: give a printable name")
    return scene
