"""A hash of the sources that decide what the benchmark measures: other code measures again."""

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from importlib import resources
from pathlib import Path

from springpot.lazy_names import homes_of

_FLOORS_BELOW = ("runtime_c", "codegen", "trainer")  # all of them: kinds are loaded by name


@cache
def code_hash(modules: tuple[str, ...], root: Path | None = None) -> str:
    """SHA-256 of the floors below, and of every module of the host that `modules` import.

    root: of the package; default: the installed one.
    """
    root = root or Path(str(resources.files("springpot.host"))).parent
    files = [
        file
        for floor in _FLOORS_BELOW
        for file in sorted((root / floor).rglob("*"))
        if file.is_file() and "__pycache__" not in file.parts
    ]
    digest = hashlib.sha256()
    for file in [*files, *sorted(_imported(root, modules))]:
        content = file.read_bytes()
        digest.update(f"{file.relative_to(root)}\n{len(content)}\n".encode() + content)
    return digest.hexdigest()


def _imported(root: Path, modules: tuple[str, ...]) -> set[Path]:
    """Files of modules of the host, and of all that they import from it, lazily too."""
    found: set[Path] = set()
    waiting = list(modules)
    while waiting:
        file = _file(root, waiting.pop())
        if file is not None and file not in found:
            found.add(file)
            waiting += _imports(root, file)
    return found


def _file(root: Path, module: str) -> Path | None:
    """The file of a module of the host, or of the package springpot itself; else None."""
    package, *path = module.split(".")
    if package != "springpot" or (len(path) > 1 and path[0] != "host"):
        return None
    if path[:1] == ["host"]:
        places = [root.joinpath(*path).with_suffix(".py")]
    else:  # in a checkout the package itself is host/api
        name = Path(*(path or ["__init__"])).with_suffix(".py")
        places = [root / "host" / "api" / name, root / name]
    return next((place for place in places if place.is_file()), None)


def _imports(root: Path, file: Path) -> Iterator[str]:
    """Modules that a file imports from: of `from package import name`, both readings.

    A public name leads to the module that defines it, not to all that its public module offers.
    """
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            source = _file(root, node.module) if node.module.count(".") < 2 else None
            homes = {} if source is None else homes_of(source)
            if not homes:
                yield node.module
            for alias in node.names:
                yield homes.get(alias.name, f"{node.module}.{alias.name}")
