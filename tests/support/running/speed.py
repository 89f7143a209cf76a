"""Which tests `make test` has time for: by a stored table of processor times, not by a clock.

tests/durations.json has the seconds of processor time of every test above LISTED_S, measured by
`make durations`. A file may use FILE_S of them in `make test`: first the cheapest case of each test
function, then further cases, cheapest first. What is beyond is marked slow, as if by hand.
"""

import json
import os
import resource
from collections import defaultdict
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from support.paths import TESTS

TABLE = TESTS / "durations.json"
LISTED_S, OTHER_S = 0.2, 0.02  # others count as so much
FILE_S = 2.0
TOTAL_S = 170.0  # of all files: test_speed.py adds the table up
_LEFT_ALONE = ("slow", "realtime")


@cache
def durations_s() -> dict[str, float]:
    """Processor time, s, by name of the test."""
    found: dict[str, float] = json.loads(TABLE.read_text())
    return found


def chosen(names: Sequence[str], table: dict[str, float], budget_s: float = FILE_S) -> set[str]:
    """Names of one file's tests that fit its budget."""
    cost = {name: table.get(name, OTHER_S) for name in names}
    cases = defaultdict(list)
    for name in names:
        cases[name.partition("[")[0]].append(name)
    first = {min(those, key=lambda name: (cost[name], name)) for those in cases.values()}
    used_s, kept = 0.0, set()
    for name in sorted(names, key=lambda name: (name not in first, cost[name], name)):
        if used_s + cost[name] <= budget_s:
            kept.add(name)
            used_s += cost[name]
    return kept


class Speed:
    """Marks tests slow that the table has no room for, or that were skipped before.

    SPRINGPOT_SKIPPED names a list of tests: it is written at the end if it is not there, and else
    its tests are slow ones, so that a machine with more tools runs what one with fewer skipped.
    SPRINGPOT_DURATIONS names a file to which each test's processor time is appended.
    """

    def __init__(self) -> None:
        self._skipped = _path("SPRINGPOT_SKIPPED")
        self._durations = _path("SPRINGPOT_DURATIONS")
        self._again = self._skipped is not None and self._skipped.is_file()

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        again = set()
        if self._again and self._skipped is not None:
            again = set(self._skipped.read_text().split("\n"))
        files = defaultdict(list)
        for item in items:
            if not any(item.get_closest_marker(mark) for mark in _LEFT_ALONE):
                files[item.nodeid.partition("::")[0]].append(item.nodeid)
        fast = {name for names in files.values() for name in chosen(names, durations_s())}
        for item in items:
            clocked = item.get_closest_marker("realtime")  # has its own run
            if not clocked and (item.nodeid in again or item.nodeid not in fast):
                item.add_marker("slow")

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Any:
        begin_s = _cpu_s()
        found = yield
        if self._durations is not None:
            with self._durations.open("a") as file:
                file.write(json.dumps([item.nodeid, round(_cpu_s() - begin_s, 2)]) + "\n")
        return found

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        if self._skipped is not None and not self._again:
            skipped = {report.nodeid for report in terminalreporter.stats.get("skipped", [])}
            self._skipped.write_text("\n".join(sorted(skipped)))


def _path(variable: str) -> Path | None:
    named = os.environ.get(variable, "")
    return Path(named) if named else None


def _cpu_s() -> float:
    """Processor time of this process and of those that it waited for, s."""
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    usages = [resource.getrusage(kind) for kind in kinds]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def write_table(measured: Path) -> None:
    """Take what a file of SPRINGPOT_DURATIONS has into TABLE; tests that did not run stay."""
    rows = dict(json.loads(line) for line in measured.read_text().splitlines())
    table = {
        name: seconds
        for name, seconds in (durations_s() | rows).items()
        if seconds >= LISTED_S and (TESTS.parent / name.partition("::")[0]).is_file()
    }
    TABLE.write_text(json.dumps(dict(sorted(table.items())), indent=0) + "\n")


if __name__ == "__main__":
    import sys

    write_table(Path(sys.argv[1]))
