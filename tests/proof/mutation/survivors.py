"""The result of a run, and the reasons of what survives."""

import json
import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from killing import ROOT, SURVIVED, UNCHANGED, Tried
from support.paths import commit

REASONS = Path(__file__).parent / "survivors.toml"
Place = tuple[str, str]  # file, function.kind of the change


@dataclass(frozen=True)
class Reason:
    """Why mutants of a place survive. equivalent: of so many no input tells the original."""

    most: int
    why: str
    equivalent: int = 0


def read_reasons() -> dict[Place, Reason]:
    """Read the reason of each place."""
    return {
        (file, f"{function}.{kind}"): Reason(**reason)
        for file, functions in tomllib.loads(REASONS.read_text()).items()
        for function, kinds in functions.items()
        for kind, reason in kinds.items()
    }


def wrong_reasons(reasons: Mapping[Place, Reason], tried: Sequence[Tried]) -> list[str]:
    """Name each place of more survivors than its reason covers, and each reason of none."""
    found = Counter((row.file, row.place) for row in tried if row.by == SURVIVED)
    files = {row.file for row in tried}
    more = [
        f"no reason: {file}: {place}: {count} survive, {_most(reasons, file, place)} have a reason"
        for (file, place), count in found.items()
        if count > _most(reasons, file, place)
    ]
    return more + [
        f"survivors.toml: {file}: {place}: none survives, take it away"
        for file, place in reasons
        if file in files and not found[file, place]
    ]


def _most(reasons: Mapping[Place, Reason], file: str, place: str) -> int:
    return reasons[file, place].most if (file, place) in reasons else 0


def write_result(out: Path, title: str, command: str, tried: Sequence[Tried]) -> int:
    """Write the figures; return how many places have no reason, or reasons no survivor.

    What `out` has of files that were not tried stays, with the commit that it was found at.
    """
    reasons = read_reasons()
    rows, survivors = _kept(out, {row.file for row in tried})
    found_at = commit()
    for file in dict.fromkeys(row.file for row in tried):
        of_file = [row for row in tried if row.file == file and row.by != UNCHANGED]
        left = _survivors(file, of_file, reasons)
        survived, equivalent = (sum(row[key] for row in left) for key in ("count", "equivalent"))
        survivors += left
        rows.append(
            {
                "file": file,
                "mutants": len(of_file),
                "caught": len(of_file) - survived,
                "equivalent": equivalent,
                "survived": survived - equivalent,
                "commit": found_at,
            }
        )
    wrong = wrong_reasons(reasons, tried)
    print("\n".join(wrong))
    total = {key: sum(row[key] for row in rows) for key in ("mutants", "caught", "equivalent")}
    share = total["caught"] / max(total["mutants"], 1)
    share_of_others = total["caught"] / max(total["mutants"] - total["equivalent"], 1)
    print(
        f"{total['caught']} of {total['mutants']} caught: {share:.1%}; "
        f"without {total['equivalent']} equivalent ones {share_of_others:.1%}"
    )
    result = {"title": title, "rows": rows, "survivors": survivors, "command": command}
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n")
    return len(wrong)


def _survivors(
    file: str, tried: Sequence[Tried], reasons: Mapping[Place, Reason]
) -> list[dict[str, Any]]:
    """Count the survivors of each place of a file, with its reason."""
    counts = Counter(row.place for row in tried if row.by == SURVIVED)
    found = []
    for place, count in counts.items():
        function, kind = place.split(".")
        reason = reasons.get((file, place), Reason(0, ""))
        found.append(
            {
                "file": file,
                "function": function,
                "change": kind,
                "count": count,
                "equivalent": min(count, reason.equivalent),
                "reason": reason.why,
            }
        )
    return found


def _kept(out: Path, tried: set[str]) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Rows and survivors of other files that are still there."""
    before = json.loads(out.read_text()) if out.exists() else {"rows": [], "survivors": []}
    rows, survivors = (
        [row for row in before[key] if row["file"] not in tried and (ROOT / row["file"]).exists()]
        for key in ("rows", "survivors")
    )
    return rows, survivors
