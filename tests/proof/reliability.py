"""Write docs/explanation/reliability.md from what the commands of its sections found.

    python tests/proof/reliability.py

Each section is made of a JSON file in docs/reliability that its command wrote;
docs/reliability/others.md is written by hand. A test compares the page.
"""

import json
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.paths import ROOT

Result = dict[str, Any]
STORED = ROOT / "docs" / "reliability"
PAGE = ROOT / "docs" / "explanation" / "reliability.md"
_FUZZ = """A finding is anything but a result or one printable line on an input under 1 MiB: a
traceback, a crash, above 10 s, above 1 GiB. `make soak` gives each target an hour; what stands here
is for the seconds stated, and says nothing about longer. Edges: of the project's Python or C; at
the start, of the seeds and of what earlier runs kept. Ended apart: what crashed or hung a library
in the fuzzer and ends in one line for users, the project reading it in a process of its own;
crashes of the MAT reader are not counted, a copy of the process meets them first.
"""
_MISRA = """**No claim of conformity**: the addon checks a part of the rules, nobody assessed the
rest. Names without a number are cppcheck's own checks. The functions of each:
`docs/reliability/misra.json`; the reasons: `tests/proof/misra/deviations.toml`.
"""
_HEAD = """# What was shown, and how

Written by `python tests/proof/reliability.py` from what the commands of each section found. No
figure of ours is typed by hand. springpot is careful with forces, and certified for nothing: what
follows is what was tried, with its limits, and no more.
"""


def page() -> str:
    """The whole page, of the stored results."""
    mutation = [_result(file.stem) for file in sorted(STORED.glob("mutation*.json"))]
    sections = [
        _HEAD,
        render_prove(_result("prove")),
        render_mutation(mutation),
        render_fuzz(_result("fuzz")),
        render_misra(_result("misra")),
        (STORED / "others.md").read_text(),
    ]
    return "\n".join(sections)


_PROVED = """\
The analyser follows the C of a scene through any number of calls in any order: samples whose
position, velocity and time step have any bits, silences of any length. No alarm means: no access
outside an object, no read of what was never written, no undefined conversion, shift or division;
the force is finite and within the scene's limits, and every number in the state is finite, after
every call. Of the protocol, the ring of bytes and the links: the same of memory, whatever bytes
come.
"""
_FOLDER = """
The C of a scene of your own is other tables: emit it with the prefix `sp`
(`springpot emit --scene scene.toml --out mine`) and analyse that folder alone with
`python tests/proof/prove.py --folder mine`, which ends with a line like `mine: 0 alarms, 7 s`.
Exit status 1 where an alarm is left, 2 where nothing was shown: without Frama-C, of no such folder,
or where the analysis does not end within an hour. A passive model takes seconds, a small forest
half a minute to five, one of thousands of nodes may not end. The folder stays; the copy that was
analysed, with the analyser's log, is in `build/prove/folder`. It does not cover the compiler and
the processor, vector units, `main.c` and whatever else calls the C, another scene beside it, nor
whether the model is right and a hand finds it stable: `springpot validate` and
`springpot stability` look at those.
"""


def render_prove(result: Result) -> str:
    """Static analysis of the emitted C, for every input."""
    title = "## Every input: static analysis of the emitted C\n"
    columns = ("scene", "kind", "coupling", "number", "alarms", "seconds")
    defects = [f"- {row['defect']}: {row['caught_by']}" for row in result["defects"]]
    return "\n".join([
        title,
        f"`{result['command']}`, {result['version']}, {result['seconds']} s on two cores.\n",
        _PROVED,
        *_table(columns, [[row[name] for name in columns] for row in result["rows"]]),
        "\nDefects that were planted, and what noticed:\n",
        *defects,
        "\nIt assumes:\n",
        *(f"- {text}" for text in result["assumptions"]),
        _FOLDER,
    ])  # fmt: skip


def render_mutation(results: list[Result]) -> str:
    """Changes of the sources one at a time, and whether a test noticed."""
    lines = ["## Would the tests notice: mutation\n"]
    lines.append(
        "Each comparison, constant, sign and assignment changed, one at a time. Equivalent: no "
        "test could notice. Share: caught, of those that are not equivalent.\n"
    )
    for result in results:
        lines += [f"### {result['title']}\n", f"`{result['command']}`.\n"]
        columns = ("file", "mutants", "caught", "equivalent", "survived", "share, %", "at commit")
        counts = columns[1:-2]
        rows = [
            [row["file"], *(row[name] for name in counts), _share(row), row["commit"]]
            for row in result["rows"]
        ]
        whole = {name: sum(row[name] for row in result["rows"]) for name in counts}
        lines += [*_table(columns, [*rows, ["all", *whole.values(), _share(whole), ""]]), ""]
        left = [row for row in result["survivors"] if row["count"] > row["equivalent"]]
        lines += ["No test notices:\n"] if left else []
        lines += [
            f"- `{row['file']}`, `{row['function']}`, {row['change']}: {row['reason']}"
            for row in left
        ]
        lines += [""] if left else []
    return "\n".join(lines)


def _share(row: dict[str, int]) -> str:
    told = row["mutants"] - row["equivalent"]
    return f"{100.0 * row['caught'] / told:.1f}" if told else ""


def render_fuzz(result: Result) -> str:
    """Readers of files and bytes under a coverage-guided fuzzer."""
    title = "## Every byte from outside: fuzzing\n"
    columns = ("target", "seconds", "executions", "edges at the start", "at the end", "peak, MiB",
               "ended apart", "findings")  # fmt: skip
    rows = [
        [row["target"], row["seconds"], row["executions"], row["edges_start"], row["edges_end"],
         row["peak_mib"], row["contained"], len(row["findings"])]
        for row in result["rows"]
    ]  # fmt: skip
    found = [f"- {row['target']}: {what}" for row in result["rows"] for what in row["findings"]]
    return "\n".join([
        title,
        f"`{result['command']}`, {result['machine']}, commit {result['commit']}.\n",
        _FUZZ,
        *_table(columns, rows),
        "",
        *(found or ["None is open. What was found before is kept as tests: "
                    "`tests/trainer/recordings/test_hostile_files.py`, "
                    "`tests/codegen/model/test_hostile_models.py`, "
                    "`tests/host/emission/test_scene_keys.py`."]),
        "",
    ])  # fmt: skip


def render_misra(result: Result) -> str:
    """Rules of MISRA C:2012 that cppcheck checks."""
    title = "## Rules of MISRA C:2012 that cppcheck checks\n"
    places = sum(row["places"] for row in result["rows"])
    rows = [
        [row["rule"], row["places"], len(row["files"]), row["reason"]] for row in result["rows"]
    ]
    return "\n".join([
        title,
        f"`{result['command']}`, {result['tool']} with its MISRA addon, {result['seconds']} s: "
        f"{len(result['programs'])} programs ({', '.join(result['programs'])}). "
        f"{len(result['rows'])} reasons for {places} places.\n",
        _MISRA,
        *_table(("rule", "places", "files", "why it stays"), rows),
        "",
    ])  # fmt: skip


def _result(name: str) -> Result:
    return json.loads((STORED / f"{name}.json").read_text())


def _table(columns: tuple[str, ...], rows: list[list[Any]]) -> list[str]:
    lines = [columns, ["---"] * len(columns), *rows]
    return ["| " + " | ".join(str(cell) for cell in line) + " |" for line in lines]


if __name__ == "__main__":
    PAGE.write_text(page())
