"""Checksums of an emitted folder: what a user changed there is never replaced."""

import hashlib
import json
from pathlib import Path

from springpot.codegen.errors import UsageError

CHECKSUMS = "from/files.json"
# What validation, report and a build by hand put beside it.
_OWN_LATER = {"validation", "report.html", "example"}


def require_replaceable(folder: Path) -> None:
    """Refuse to replace a folder in which anything is not as springpot wrote it."""
    if folder.is_file():
        raise UsageError(f"{folder}: is a file: give a folder to --out")
    if folder.exists() and any(folder.iterdir()):
        if not (folder / CHECKSUMS).exists():
            raise UsageError(
                f"{folder}: holds files that springpot did not emit: give --out an empty or new "
                "folder"
            )
        known = json.loads((folder / CHECKSUMS).read_text())
        for file in sorted(folder.rglob("*")):
            name = str(file.relative_to(folder))
            if file.is_dir() or name == CHECKSUMS or name.split("/", maxsplit=1)[0] in _OWN_LATER:
                continue
            if known.get(name) != hashlib.sha256(file.read_bytes()).hexdigest():
                raise UsageError(
                    f"{file}: not as springpot emitted it: move your changes out of {folder}, or "
                    "give --out another folder"
                )
    folder.parent.mkdir(parents=True, exist_ok=True)


def write_checksums(folder: Path) -> None:
    """SHA-256 of every file of a new emission, in the folder itself."""
    files = [file for file in folder.rglob("*") if file.is_file()]
    checksums = {
        str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in files
    }
    (folder / CHECKSUMS).write_text(json.dumps(checksums, indent=2, sort_keys=True) + "\n")
