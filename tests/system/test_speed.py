"""`make test` has room for what it runs: the stored table is added up, no clock is asked."""

import pytest
from support.running.speed import REST_TOTAL_S, TOTAL_S, USED_S, chosen

TABLE = {"a.py::one[1]": 3.0, "a.py::one[2]": 2.0, "a.py::two": 1.5, "a.py::three": 9.0}
CASES = dict.fromkeys([*TABLE, "a.py::new"], ())


@pytest.mark.parametrize(
    ("budget_s", "fits"),
    [
        ((4.0, 4.0), ["one[2]", "two", "new"]),
        ((4.0, 7.0), ["one[1]", "one[2]", "two", "new"]),
        ((20.0, 0.0), ["one[2]", "two", "three", "new"]),
        ((1.0, 1.0), ["new"]),
    ],
)
def test_each_property_has_its_cheapest_case_before_any_has_a_second(
    budget_s: tuple[float, float], fits: list[str]
) -> None:
    kept, used_s = chosen(CASES, TABLE, budget_s)
    assert kept == {f"a.py::{name}" for name in fits}
    assert used_s == pytest.approx(sum(TABLE.get(name, 0.01) for name in kept))


def test_what_tests_share_is_paid_once_by_those_that_need_it() -> None:
    table = {"a.py::[folder]": 3.0}
    cases = {"a.py::one": ["a.py::[folder]"], "a.py::two": ["a.py::[folder]"], "a.py::three": []}
    assert chosen(cases, table, (3.1, 0.0)) == (set(cases), pytest.approx(3.03))
    assert chosen(cases, table, (3.0, 0.0))[0] == {"a.py::three"}


def test_what_is_run_is_within_its_budget(request: pytest.FixtureRequest) -> None:
    fast_s, rest_s = request.config.stash[USED_S]
    assert fast_s <= TOTAL_S
    assert rest_s <= REST_TOTAL_S
