"""Readers of files and bytes against a coverage-guided fuzzer: atheris, and libFuzzer for C.

    python tests/proof/fuzz/fuzz.py [--seconds 3600] [--target NAME ...] [--json FILE]

One target after the other, each for so long. A target fails where an input under 1 MiB leads to
anything but a result or one line for users, takes above 10 s, or above 1 GiB. What was found lies
in build/fuzz/NAME/findings; the status is then 1. `make soak` gives each an hour.
"""

import argparse
import json
import platform
import shutil
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))
from proof.fuzz.harness import READERS
from proof.fuzz.targets import missing_for, prepare, run_target
from support.paths import ROOT, commit

RESULT = ROOT / "build" / "fuzz.json"
WORK = ROOT / "build" / "fuzz"


def main() -> int:
    """Run what was asked for; the result joins what the file says of other targets."""
    parser = argparse.ArgumentParser(description="fuzz the readers")
    parser.add_argument("--seconds", type=int, default=3600, help="for each target")
    parser.add_argument("--target", action="append", choices=[*READERS, "wire"])
    parser.add_argument("--json", type=Path, default=RESULT, help="where the result goes")
    options = parser.parse_args()
    rows = {row["target"]: row for row in _stored(options.json)}
    failed = False
    for name in options.target or [*READERS, "wire"]:
        if problem := missing_for(name):
            print(f"{name}: not run: {problem}", file=sys.stderr)
            continue
        folder = WORK / name
        shutil.rmtree(folder / "findings", ignore_errors=True)
        row = run_target(name, prepare(name, folder), folder, options.seconds)
        failed |= bool(row["findings"])
        rows[name] = row
        print(json.dumps(row), flush=True)
        _store(options.json, [rows[target] for target in (*READERS, "wire") if target in rows])
    return 1 if failed else 0


def _stored(file: Path) -> list[dict[str, Any]]:
    return json.loads(file.read_text())["rows"] if file.exists() else []


def _store(file: Path, rows: list[dict[str, Any]]) -> None:
    result = {
        "command": "python tests/proof/fuzz/fuzz.py",
        "commit": commit(),
        "machine": f"{platform.machine()}, Python {platform.python_version()}",
        "rows": rows,
    }
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    sys.exit(main())
