"""`make misra`: rules of MISRA C:2012 that cppcheck's addon checks, over runtime_c and emitted C.

    python tests/proof/misra/misra.py [--json docs/reliability/misra.json] [--list]

Fails where a rule is broken and deviations.toml has no record of it for that file, and where a
record covers nothing. This is no claim of conformity: the addon checks some of the rules, rules
about the whole of a project by none of them.
--list: print every place, to write a record from or to mend.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))
from proof.misra.analysis import by_rule_and_file, missing_tool, places_of, tool_version
from proof.misra.programs import PORT, RUNTIME, programs
from support.paths import ROOT

RECORDS = Path(__file__).parent / "deviations.toml"
RESULT = ROOT / "docs" / "reliability" / "misra.json"
Found = Counter[tuple[str, str]]


def unrecorded(found: Found, records: list[dict[str, Any]]) -> list[str]:
    """Each rule that is broken in a file without a record, one line each."""
    covered = {(record["rule"], file) for record in records for file in record["files"]}
    return [
        f"rule {rule} is broken in {file} ({count} places): mend it, or write a record"
        for (rule, file), count in sorted(found.items())
        if (rule, file) not in covered
    ]


def idle_records(found: Found, records: list[dict[str, Any]]) -> list[str]:
    """Each record of a file where its rule is kept, one line each.

    Where the addon's places vary from run to run, a record is idle when none of its files has one.
    """
    return [
        f"the record of rule {record['rule']} for {file} covers nothing: take it away"
        for record in records
        for file in record["files"]
        if (record["rule"], file) not in found
        and not (
            record.get("places_vary")
            and any((record["rule"], name) in found for name in record["files"])
        )
    ]


def rows(found: Found, records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Each record with the number of places that it covers."""
    return [
        {**record, "places": sum(found[record["rule"], file] for file in record["files"])}
        for record in records
    ]


def main() -> int:
    """Analyse, compare, write; the number of lines that are wrong is none, or the status is 1."""
    parser = argparse.ArgumentParser(description="cppcheck's MISRA addon, with deviations")
    parser.add_argument("--json", type=Path, default=RESULT, help="where the result goes")
    parser.add_argument("--list", action="store_true", help="print every place")
    options = parser.parse_args()
    if problem := missing_tool():
        print(problem, file=sys.stderr)
        return 2
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        analysed = programs(Path(folder))
        left = {file.name for file in (RUNTIME / "src").iterdir()}
        left -= {file.name for file in Path(folder).rglob("*.h")}
        places = places_of(analysed, os.cpu_count() or 1)
    if options.list:
        for rule, file, line, column in sorted(places):
            print(f"{rule}\t{file}:{line}:{column}")
    found = by_rule_and_file(places)
    records = tomllib.loads(RECORDS.read_text())["deviation"]
    wrong = unrecorded(found, records) + idle_records(found, records)
    wrong += [f"no scene includes {name}: give one in programs.py" for name in sorted(left)]
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, text=True,
                            capture_output=True, check=False).stdout.strip()  # fmt: skip
    result = {
        "command": "make misra",
        "tool": tool_version(),
        "commit": commit,
        "seconds": round(time.monotonic() - begin),
        "programs": [program.name for program in analysed],
        "files": len([*(RUNTIME / "src").iterdir(), *PORT.rglob("*.[ch]")]),
        "rows": rows(found, records),
        "wrong": wrong,
    }
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n")
    for line in wrong:
        print(line, file=sys.stderr)
    kept = sum(row["places"] for row in result["rows"])
    print(f"{len(records)} records for {kept} places, {len(wrong)} wrong, {result['seconds']} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
