"""The page on reliability is what its command makes of the results; a section can be missing."""

import json
import tomllib
from collections import Counter

from proof.functions import functions_by_line
from proof.misra.misra import RECORDS, RESULT, stored_places, wrong_places
from proof.reliability import PAGE, page
from support.paths import ROOT


def test_the_page_is_what_the_command_makes_of_the_results() -> None:
    assert PAGE.read_text() == page(), "run python tests/proof/reliability.py"


def test_the_stored_places_of_rules_are_of_the_reasons_and_of_functions_that_are_there() -> None:
    records, result = tomllib.loads(RECORDS.read_text()), json.loads(RESULT.read_text())
    reasons = records["reasons"]
    assert all(len(reason) > 20 for reason in reasons.values())
    assert {row["rule"]: row["reason"] for row in result["rows"]} == reasons
    assert set(records["places_vary"]) <= set(reasons)
    for _, file, function in stored_places(result):
        if not file.startswith("emitted/"):
            assert function in functions_by_line((ROOT / file).read_text(), is_python=False), file


def test_places_and_records_are_compared_both_ways() -> None:
    place = ("1.1", "a.c", "f")
    records = {"reasons": {"1.1": "of no matter"}, "places_vary": []}
    found = Counter({place: 2})
    assert wrong_places(found, records, found) == []
    new, more = Counter({("1.1", "a.c", "g"): 1, **found}), Counter({place: 3})
    for others in (new, more):
        (line,) = wrong_places(others, records, found)
        assert "rule 1.1 is broken in a.c, " in line
        assert wrong_places(others, {**records, "places_vary": ["1.1"]}, found) == []
    assert len(wrong_places(Counter({**found, ("2.2", "a.c", "f"): 1}), records, found)) == 1
    assert wrong_places(Counter(), records, found) == [
        "the reason of rule 1.1 covers nothing: take it away"
    ]
