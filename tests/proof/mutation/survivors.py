"""The result of a run for docs/explanation/reliability.md, and the reasons of what survives."""

import json
import subprocess
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from killing import ROOT, SURVIVED, UNCHANGED, Tried

REASONS = Path(__file__).parent / "survivors.toml"


@dataclass(frozen=True)
class Reason:
    """Why a mutant survives. equivalent: no input tells it from the original."""

    file: str
    line: str
    change: str
    why: str
    equivalent: bool = False

    @property
    def key(self) -> tuple[str, str, str]:
        return self.file, self.line, self.change


def read_reasons() -> list[Reason]:
    """Each entry has one reason and the mutants of one file that it is true of."""
    reasons = []
    for entry in tomllib.loads(REASONS.read_text())["reason"]:
        for line, change in entry["mutants"]:
            reasons.append(
                Reason(entry["file"], line, change, entry["why"], entry.get("equivalent", False))
            )
    return reasons


def stale(reasons: Sequence[Reason], tried: Sequence[Tried]) -> list[str]:
    """Reasons that name no survivor of the files that were tried."""
    survivors = {(row.file, row.line, row.change) for row in tried if row.by == SURVIVED}
    files = {row.file for row in tried}
    return [
        f"survivors.toml: {reason.file}: `{reason.line}` -> `{reason.change}` does not survive"
        for reason in reasons
        if reason.file in files and reason.key not in survivors
    ]


def write_result(out: Path, title: str, command: str, tried: Sequence[Tried]) -> int:
    """Write the figures; how many survivors have no reason, or reasons no survivor.

    What `out` has of files that were not tried stays, with the commit that it was found at.
    """
    reasons = {reason.key: reason for reason in read_reasons()}
    rows, survivors, unexplained = _kept(out, {row.file for row in tried})
    commit = _commit()
    for file in dict.fromkeys(row.file for row in tried):
        of_file = [row for row in tried if row.file == file and row.by != UNCHANGED]
        left = [row for row in of_file if row.by == SURVIVED]
        equivalent = 0
        for row in left:
            reason = reasons.get((row.file, row.line, row.change))
            equivalent += reason is not None and reason.equivalent
            unexplained += reason is None
            survivors.append(
                {
                    "file": row.file,
                    "line": row.line,
                    "change": row.change,
                    "equivalent": reason is not None and reason.equivalent,
                    "reason": reason.why if reason else "",
                }
            )
            if reason is None:
                print(f"no reason: {row.file}:{row.number}: {row.line}\n    -> {row.change}")
        rows.append(
            {
                "file": file,
                "mutants": len(of_file),
                "caught": len(of_file) - len(left),
                "equivalent": equivalent,
                "survived": len(left) - equivalent,
                "commit": commit,
            }
        )
    old = stale(list(reasons.values()), tried)
    print("\n".join(old))
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
    return unexplained + len(old)


def _kept(out: Path, tried: set[str]) -> tuple[list[dict[str, Any]], list[dict[str, Any]], int]:
    """Rows and survivors of other files, and how many of those have no reason."""
    if not out.exists():
        return [], [], 0
    before = json.loads(out.read_text())
    rows, survivors = (
        [row for row in before[key] if row["file"] not in tried and (ROOT / row["file"]).exists()]
        for key in ("rows", "survivors")
    )
    return rows, survivors, sum(not row["reason"] for row in survivors)


def _commit() -> str:
    return subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"],
        cwd=ROOT, check=True, capture_output=True, text=True,
    ).stdout.strip()  # fmt: skip
