"""`make misra`: rules of MISRA C:2012 that cppcheck's addon checks, over runtime_c and emitted C.

    python tests/proof/misra/misra.py [--json docs/reliability/misra.json] [--list] [--record]

Fails if a rule is broken without a reason in deviations.toml, or in a function more often than the
stored result has it, and if a reason covers nothing. This is no claim of conformity: the addon
checks some of the rules, and no rule about a whole project.
--list: print every place, to mend it or to record it.
--record: store what is found as what may be found, after a change of the C that was looked at.
"""

import argparse
import json
import os
import sys
import tempfile
import time
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))
from proof.misra.analysis import by_function, missing_tool, places_of, tool_version
from proof.misra.programs import PORT, RUNTIME, programs
from support.paths import ROOT, commit

RECORDS = Path(__file__).parent / "deviations.toml"
RESULT = ROOT / "docs" / "reliability" / "misra.json"
Found = Counter[tuple[str, str, str]]  # places by rule, file and function


def stored_places(result: dict[str, Any]) -> Found:
    """Read what a stored result has found."""
    return Counter(
        {
            (row["rule"], file, function): count
            for row in result["rows"]
            for file, functions in row["files"].items()
            for function, count in functions.items()
        }
    )


def wrong_places(found: Found, records: dict[str, Any], stored: Found) -> list[str]:
    """Say in a line each: a rule without a reason, a new place, and a reason without a place."""
    reasons, rules = records["reasons"], {rule for rule, _, _ in found}
    wrong = [f"rule {rule} is broken: mend it, or write a reason" for rule in rules - set(reasons)]
    wrong += [
        f"rule {rule} is broken in {file}, {function} ({count} places, {stored[place]} recorded): "
        "mend it, or --record it"
        for place, count in found.items()
        for rule, file, function in [place]
        if rule in reasons and rule not in records["places_vary"] and count > stored[place]
    ]
    wrong += [f"the reason of rule {rule} covers nothing: take it away" for rule in reasons
              if rule not in rules]  # fmt: skip
    return sorted(wrong)


def rows(found: Found, reasons: dict[str, str]) -> list[dict[str, Any]]:
    """List each rule with its reason and its places: how many in which function of which file."""
    made = []
    for rule, reason in reasons.items():
        files: dict[str, dict[str, int]] = {}
        for place in sorted(found):
            if place[0] == rule:
                files.setdefault(place[1], {})[place[2]] = found[place]
        places = sum(sum(functions.values()) for functions in files.values())
        made.append({"rule": rule, "reason": reason, "places": places, "files": files})
    return made


def main() -> int:
    """Analyse, compare, store; return 1 if something is wrong."""
    parser = argparse.ArgumentParser(description="cppcheck's MISRA addon, with deviations")
    parser.add_argument("--json", type=Path, default=RESULT, help="where the result goes")
    parser.add_argument("--list", action="store_true", help="print every place")
    parser.add_argument("--record", action="store_true", help="take all places for recorded")
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
        for rule, file, function, line, column in sorted(set().union(*places)):
            print(f"{rule}\t{file}:{line}:{column}\t{function}")
    found = by_function(places)
    records = tomllib.loads(RECORDS.read_text())
    stored = found if options.record else stored_places(json.loads(RESULT.read_text()))
    wrong = wrong_places(found, records, stored)
    wrong += [f"no scene includes {name}: give one in programs.py" for name in sorted(left)]
    for line in wrong:
        print(line, file=sys.stderr)
    seconds = round(time.monotonic() - begin)
    print(f"{found.total()} places of {len(records['reasons'])} rules, {len(wrong)} wrong")
    if wrong:
        return 1
    result = {
        "command": "make misra",
        "tool": tool_version(),
        "commit": commit(),
        "seconds": seconds,
        "programs": [program.name for program in analysed],
        "c_files": len([*(RUNTIME / "src").iterdir(), *PORT.rglob("*.[ch]")]),
        "rows": rows(found, records["reasons"]),
    }
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
