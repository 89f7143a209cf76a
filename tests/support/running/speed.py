"""Which tests there is time for: by a stored table of processor times, not by a clock.

tests/durations.json has the seconds of processor time of every test above LISTED_S, and of every
fixture that tests of a file share, measured by `make durations` on an empty cache of built
libraries. A file may use the first number of FAST_S in `make test` for the cheapest case of each
test function; further cases are added, cheapest first, while it uses less than the second. A
shared fixture is paid by the first that needs it. What is beyond is marked slow, as if by hand. Of
those that are slow a file may use REST_S in `make test-rest`; what is beyond is marked long.
"""

import json
import os
import resource
from collections import defaultdict
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from support.paths import TESTS

TABLE = TESTS / "durations.json"
LISTED_S, OTHER_S = 0.1, 0.01  # others count as so much
FAST_S, TOTAL_S = (2.75, 0.6), 230.0  # of a file, of all: test_speed.py adds them up
REST_S, REST_TOTAL_S = (17.5, 1.75), 800.0
WORTH = {"tests/system/test_forces.py": (12.0, 12.0)}  # every kind's forces, bit for bit
USED_S = pytest.StashKey[tuple[float, float]]()  # what `make test` and `make test-rest` choose
_PAID, _SHARED = "processor_s", "shared_s"


@cache
def durations_s() -> dict[str, float]:
    """Processor time, s, by name of the test, or by FILE::[FIXTURE]."""
    return json.loads(TABLE.read_text())


def chosen(
    cases: Mapping[str, Sequence[str]], table: Mapping[str, float], budget_s: tuple[float, float]
) -> tuple[set[str], float]:
    """Choose the tests of one file that fit its budget; the seconds that they use.

    cases: names of shared fixtures, as in the table, by name of the test.
    """
    first: dict[str, str] = {}
    for name in sorted(cases, key=lambda name: (_cost_s(name, cases[name], table), name)):
        first.setdefault(name.partition("[")[0], name)
    used_s, kept, paid = 0.0, set(), set[str]()
    order = {name: (first[name.partition("[")[0]] != name, table.get(name, OTHER_S), name)
             for name in cases}  # fmt: skip
    for name in sorted(cases, key=order.__getitem__):
        cost_s = _cost_s(name, set(cases[name]) - paid, table)
        if used_s + cost_s <= budget_s[order[name][0]]:
            kept.add(name)
            paid.update(cases[name])
            used_s += cost_s
    return kept, used_s


def _cost_s(name: str, shared: Sequence[str] | set[str], table: Mapping[str, float]) -> float:
    return table.get(name, OTHER_S) + sum(table.get(fixture, 0.0) for fixture in shared)


class Speed:
    """Marks tests slow and long that the table has no room for.

    Slow are also those that were skipped before.

    SPRINGPOT_SKIPPED names a list of tests: it is written at the end if it is not there, and else
    its tests are slow ones, so that a machine with more tools runs what one with fewer skipped.
    SPRINGPOT_DURATIONS names a file for the processor times of tests and shared fixtures.
    """

    def __init__(self) -> None:
        self._skipped = _path("SPRINGPOT_SKIPPED")
        self._durations = _path("SPRINGPOT_DURATIONS")
        self._again = self._skipped is not None and self._skipped.is_file()
        self._begin_s = 0.0
        self._shared_s: dict[str, float] = {}  # of the test that runs
        self._measured: dict[str, float] = {}

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        again = set()
        if self._again and self._skipped is not None:
            again = set(self._skipped.read_text().split("\n"))
        timed = [item for item in items if not item.get_closest_marker("realtime")]
        fast, fast_s = _chosen_of(
            [item for item in timed if not item.get_closest_marker("slow")], FAST_S
        )
        slow = [item for item in timed if item.nodeid in again or item.nodeid not in fast]
        rest, rest_s = _chosen_of(slow, REST_S)
        for item in slow:
            item.add_marker("slow")
            if item.nodeid not in rest:
                item.add_marker("long")
        config.stash[USED_S] = fast_s, rest_s

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self) -> Any:
        self._begin_s, self._shared_s = _cpu_s(), {}
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any, request: Any) -> Any:
        begin_s = _cpu_s()
        found = yield
        if fixturedef.scope != "function":
            file = request.node.nodeid.partition("::")[0]
            self._shared_s[f"{file}::[{fixturedef.argname}]"] = _cpu_s() - begin_s
        return found

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, call: pytest.CallInfo[None]) -> Any:
        report = yield
        if call.when == "teardown":
            own_s = _cpu_s() - self._begin_s - sum(self._shared_s.values())
            report.user_properties += [(_PAID, own_s), (_SHARED, self._shared_s)]
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        found: dict[str, Any] = dict(report.user_properties)
        if _PAID in found:
            self._measured |= {report.nodeid: found[_PAID], **found[_SHARED]}

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        if self._skipped is not None and not self._again:
            skipped = {report.nodeid for report in terminalreporter.stats.get("skipped", [])}
            self._skipped.write_text("\n".join(sorted(skipped)))
        if self._durations is not None:
            self._durations.write_text(json.dumps(self._measured))
        for name, seconds in self._measured.items():
            if seconds > FAST_S[0] + 2.0 * durations_s().get(name, OTHER_S):
                terminalreporter.write_line(
                    f"SLOW {name}: {seconds:.1f} s, not {durations_s().get(name, OTHER_S):g}: "
                    "`make durations`"
                )


def _chosen_of(
    items: Sequence[pytest.Item], budget_s: tuple[float, float]
) -> tuple[set[str], float]:
    """Choose from every file what fits its budget; the seconds of all."""
    files: dict[str, dict[str, list[str]]] = defaultdict(dict)
    for item in items:
        file = item.nodeid.partition("::")[0]
        shared = (f"{file}::[{name}]" for name in getattr(item, "fixturenames", ()))
        files[file][item.nodeid] = [name for name in shared if name in durations_s()]
    found = [
        chosen(cases, durations_s(), WORTH.get(file, budget_s)) for file, cases in files.items()
    ]
    return set().union(*(kept for kept, _ in found)), sum(used_s for _, used_s in found)


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
    rows: dict[str, float] = json.loads(measured.read_text())
    table = {
        name: round(seconds, 2)
        for name, seconds in (durations_s() | rows).items()
        if seconds >= LISTED_S and (TESTS.parent / name.partition("::")[0]).is_file()
    }
    TABLE.write_text(json.dumps(dict(sorted(table.items())), indent=0) + "\n")


if __name__ == "__main__":
    import sys

    write_table(Path(sys.argv[1]))
