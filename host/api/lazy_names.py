"""Load the names of a public module one by one, when each is first used."""

import ast
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

_WINGS = "springpot.host.wings"  # folders that an installation may leave out


def lazy_names(
    module: str, file: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a public module.

    The names are those that its block `if TYPE_CHECKING:` imports: written once, for checkers,
    editors and the interpreter alike. Raises AttributeError for any other name, ImportError for one
    of a wing that is not installed.

        __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
    """
    homes = homes_of(Path(file))

    def loaded(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {module!r} has no attribute {name!r}: see dir({module})")
        try:
            return getattr(import_module(homes[name]), name)
        except ModuleNotFoundError as error:
            if (error.name or "").startswith(_WINGS):
                raise ImportError(
                    f"{module}.{name}: this part of springpot is not installed here: install all "
                    "of springpot"
                ) from None
            raise

    names = sorted(homes)
    return loaded, lambda: names, names


def homes_of(file: Path) -> dict[str, str]:
    """Map each name that the block `if TYPE_CHECKING:` of a file imports to its module."""
    source = file.read_text(encoding="utf-8")
    blocks = [
        node.body
        for node in ast.parse(source).body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    ]
    return {
        alias.name: node.module
        for body in blocks
        for node in body
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }
