"""A hash of the sources that decide what the benchmark measures: other code measures again."""

import hashlib
from functools import cache
from importlib import resources
from pathlib import Path

_FLOORS = ("runtime_c", "codegen", "trainer", "host")
_BESIDE = ("host/api", "host/commands", "host/wings")  # offer names, call, or are other wings
_MEASURING = tuple(f"host/wings/evidence/benchmark/{name}.py" for name in ("measure", "isolated"))


@cache
def code_hash(root: Path | None = None) -> str:
    """SHA-256 of all floors without commands and wings, and of what measures here.

    root: of the package; default: the installed one.
    """
    root = root or Path(str(resources.files("springpot.host"))).parent
    files = {root / name for name in _MEASURING}
    for floor in _FLOORS:
        files |= {file for file in (root / floor).rglob("*") if file.is_file()
                  and "__pycache__" not in file.parts
                  and not file.relative_to(root).as_posix().startswith(_BESIDE)}  # fmt: skip
    digest = hashlib.sha256()
    for file in sorted(files):
        content = file.read_bytes()
        digest.update(f"{file.relative_to(root)}\n{len(content)}\n".encode() + content)
    return digest.hexdigest()
