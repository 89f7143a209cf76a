"""The mutators change what they say, once each; and every reason for a survivor names real code."""

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest
from killing import ROOT, SURVIVED, Tried, _tasks
from mutants_c import mutants_of_c
from mutants_python import mutants_of_python, same_program
from mutate_c import PROGRAMS
from mutate_python import TESTS
from proof.functions import functions_by_line
from survivors import Reason, read_reasons, write_result, wrong_reasons

C_TEXT = """#define LIMIT (2 * 3) /* a < b */
static int f(const int *a, double x)
{
    int n = -1; // n = 7
    n += *a & LIMIT;
    if (x <= 0.5 && !n) {
        return n;
    }
    return 0x10;
}
"""
C_CHANGES = [
    "#define LIMIT (3 * 3) /* a < b */",
    "#define LIMIT (1 * 3) /* a < b */",
    "#define LIMIT (2 / 3) /* a < b */",
    "#define LIMIT (2 * 4) /* a < b */",
    "#define LIMIT (2 * 2) /* a < b */",
    "static int f(const int /a, double x)",  # no C: found by the compiler
    "; // n = 7",
    "int n = 0; // n = 7",
    "int n = 1; // n = 7",
    "int n = -2; // n = 7",
    "int n = -0; // n = 7",
    ";",
    "n -= *a & LIMIT;",
    "n = *a & LIMIT;",
    "n += *a | LIMIT;",
    "n += *a & (LIMIT + 1);",
    "if (x < 0.5 && !n) {",
    "if (x > 0.5 && !n) {",
    "if (x <= (2 * 0.5) && !n) {",
    "if (x <= (0.5 * 0.5) && !n) {",
    "if (x <= 0.5 || !n) {",
    "if (x <= 0.5 && n) {",
    "return 0;",
    "return 0;",
    "return 0x11;",
]
PYTHON_TEXT = '''"""Of a < b."""
LIMIT = 2 * 3.0


def f(a: int, b: str = "two words") -> int:
    """1 + 1."""
    if a is not None and not a <= 0:  # not in
        raise ValueError(f"{a + 1}")
    call(a)
    return -a
'''
PYTHON_CHANGES = [
    "LIMIT = None",
    "LIMIT = 3 * 3.0",
    "LIMIT = 1 * 3.0",
    "LIMIT = 2 / 3.0",
    "LIMIT = 2 * (2 * 3.0)",
    "LIMIT = 2 * (0.5 * 3.0)",
    "if a is None and not a <= 0: # not in",
    "if a is not None or not a <= 0: # not in",
    "if a is not None and a <= 0: # not in",
    "if a is not None and not a < 0: # not in",
    "if a is not None and not a > 0: # not in",
    "if a is not None and not a <= 1: # not in",
    "...",
    "...",
    "return None",
    "return a",
]


def test_every_single_change_of_c_is_made_once() -> None:
    changes = [mutant.lines(C_TEXT)[1] for mutant in mutants_of_c(C_TEXT)]
    assert sorted(changes) == sorted(C_CHANGES)


def test_every_single_change_of_python_is_made_once() -> None:
    changes = [mutant.lines(PYTHON_TEXT)[1] for mutant in mutants_of_python(PYTHON_TEXT)]
    assert sorted(changes) == sorted(PYTHON_CHANGES)


def test_what_is_the_same_bytecode_or_none_is_not_counted() -> None:
    assert same_program("a = 1 + 1\n", "a = 2  # or 3\n")
    assert same_program("a = 1\n", "a = = 1\n")
    assert not same_program("a = 1\n", "a = 1.0\n")
    assert not same_program("def f():\n    return 1\n", "def f():\n    return 2\n")


def test_reasons_and_survivors_are_compared_both_ways() -> None:
    row = Tried("a.c", "", 3, "x < 1;", "x <= 1;", SURVIVED, "f.comparison")
    reasons = {("a.c", "f.comparison"): Reason(1, "equal")}
    assert wrong_reasons(reasons, [row]) == []
    assert len(wrong_reasons({}, [row])) == 1
    assert len(wrong_reasons(reasons, [row, row])) == 1  # one more than it covers
    assert len(wrong_reasons(reasons, [replace(row, by="test_a")])) == 1
    assert wrong_reasons(reasons, [replace(row, file="b.c", by="test_a")]) == []  # not tried


@pytest.mark.parametrize("file", sorted({file for file, _ in read_reasons()}))
def test_reasons_name_changes_of_functions_that_are_there(file: str) -> None:
    mutants_of = mutants_of_python if Path(file).suffix == ".py" else mutants_of_c
    there = Counter(task.tried.place for task in _tasks(file, mutants_of))
    for (named, place), reason in read_reasons().items():
        assert named != file or there[place] >= reason.most >= reason.equivalent, place


def test_a_line_is_of_the_innermost_function() -> None:
    assert functions_by_line(C_TEXT, is_python=False)[1:11] == ["f"] * 9 + ["outside"]
    inner = "class A:\n    def f(self):\n        def g():\n            pass\n        g()\n"
    named = ["outside", "f", "g", "g", "f", "outside"]
    assert functions_by_line(inner, is_python=True) == named


def test_files_and_their_tests_are_there() -> None:
    programs = [f"tests/c/{name}.c" for names in PROGRAMS.values() for name in names]
    tests = [test for named in TESTS.values() for test in named]
    for name in [*PROGRAMS, *programs, *TESTS, *tests]:
        assert (ROOT / name.partition("::")[0]).is_file(), name


def test_a_run_of_one_file_keeps_the_figures_of_the_others(tmp_path: Path) -> None:
    """Not of files that are gone; each has the commit that it was found at."""
    out = tmp_path / "mutation.json"
    kept = {"file": "codegen/scene.py", "mutants": 4, "caught": 3, "equivalent": 0, "survived": 1,
            "commit": "old"}  # fmt: skip
    survivor = {"file": "codegen/scene.py", "function": "f", "change": "value", "reason": "none"}
    again = {**kept, "file": "host/devices/url.py"}
    gone = {**kept, "file": "host/gone.py"}
    out.write_text(json.dumps({"rows": [kept, again, gone], "survivors": [survivor]}))
    caught = Tried("host/devices/url.py", "0", 1, "x < 1", "x <= 1", "a test")
    assert write_result(out, "Of Python", "command", [caught]) == 0
    result = json.loads(out.read_text())
    assert result["rows"][0] == kept
    assert [row["file"] for row in result["rows"]] == ["codegen/scene.py", "host/devices/url.py"]
    assert result["rows"][1]["caught"] == 1
    assert result["rows"][1]["commit"] not in ("", "old")
    assert result["survivors"] == [survivor]
