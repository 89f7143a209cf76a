"""`make test` has room for what it runs: the stored table is added up, no clock is asked."""

from support.paths import ROOT
from support.running.speed import TOTAL_S, chosen, durations_s

TABLE = {"a.py::one[1]": 3.0, "a.py::one[2]": 2.0, "a.py::two": 1.5, "a.py::three": 9.0}


def test_each_property_has_its_cheapest_case_before_any_has_a_second() -> None:
    names = [*TABLE, "a.py::new"]
    assert chosen(names, TABLE, 4.0) == {"a.py::one[2]", "a.py::two", "a.py::new"}
    assert chosen(names, TABLE, 7.0) == {"a.py::one[1]", "a.py::one[2]", "a.py::two", "a.py::new"}
    assert chosen(names, TABLE, 1.0) == {"a.py::new"}


def test_what_make_test_runs_is_within_its_budget() -> None:
    files: dict[str, list[str]] = {}
    for name in durations_s():
        files.setdefault(name.partition("::")[0], []).append(name)
    used_s = {file: sum(durations_s()[name] for name in chosen(names, durations_s()))
              for file, names in files.items()}  # fmt: skip
    assert sum(used_s.values()) <= TOTAL_S
    assert all((ROOT / file).is_file() for file in files), "make durations: files have moved"
