"""A hash of the sources that decide what the benchmark measures: other code measures again."""

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from importlib import resources
from pathlib import Path

_FLOORS_BELOW = ("runtime_c", "codegen", "trainer")  # all of them: kinds are loaded by name
_HOST = ("springpot", "host")


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
        package, *path = waiting.pop().split(".")
        file = root.joinpath(*path).with_suffix(".py")
        if (package, *path[:1]) == _HOST and file.is_file() and file not in found:
            found.add(file)
            waiting += _imports(file)
    return found


def _imports(file: Path) -> Iterator[str]:
    """Names that a file imports; of `from package import name`, both readings."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
