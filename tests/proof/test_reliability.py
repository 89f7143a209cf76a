"""The page on reliability is what its command makes of the results; a section can be missing."""

import json
import tomllib
from pathlib import Path

from proof.misra.misra import RECORDS, RESULT, idle_records, unrecorded
from proof.reliability import PAGE, page
from support.paths import ROOT


def test_the_page_is_what_the_command_makes_of_the_results() -> None:
    assert PAGE.read_text() == page(), "run python tests/proof/reliability.py"


def test_a_section_without_a_result_says_so(tmp_path: Path) -> None:
    assert page(tmp_path).count("\nNot run.\n") == 4


def test_what_others_write_becomes_a_section(tmp_path: Path) -> None:
    row = {"file": "a.c", "mutants": 11, "caught": 9, "equivalent": 1, "survived": 1,
           "commit": "abc"}  # fmt: skip
    survivor = {"file": "a.c", "function": "f", "change": "value", "count": 2, "equivalent": 1,
                "reason": "of no matter"}  # fmt: skip
    mutation = {"title": "Of C", "command": "x", "rows": [row], "survivors": [survivor]}
    (tmp_path / "mutation.json").write_text(json.dumps(mutation))
    scene = {"scene": "s", "kind": "rf-fd", "coupling": "off", "number": "float32", "alarms": 0,
             "seconds": 2}  # fmt: skip
    prove = {"command": "make prove", "version": "v", "seconds": 3, "rows": [scene],
             "defects": [{"defect": "no clamp", "caught_by": "Eva"}],
             "assumptions": ["IEEE"]}  # fmt: skip
    (tmp_path / "prove.json").write_text(json.dumps(prove))
    made = page(tmp_path)
    assert "| a.c | 11 | 9 | 1 | 1 | 90.0 | abc |" in made
    assert "- `a.c`, `f`, value: of no matter" in made
    assert "| s | rf-fd | off | float32 | 0 | 2 |" in made
    assert "- no clamp: Eva" in made


def test_every_deviation_has_a_reason_and_files_that_exist() -> None:
    records = tomllib.loads(RECORDS.read_text())["deviation"]
    for record in records:
        assert len(record["reason"]) > 20
        kept = [file for file in record["files"] if not file.startswith("emitted/")]
        assert all((ROOT / file).exists() for file in kept), record["rule"]
        assert record["files"] == sorted(set(record["files"])), record["rule"]


def test_the_stored_result_is_of_the_stored_records() -> None:
    records = tomllib.loads(RECORDS.read_text())["deviation"]
    result = json.loads(RESULT.read_text())
    assert not result["wrong"]
    stored = [{k: v for k, v in row.items() if k != "places"} for row in result["rows"]]
    assert stored == records


def test_places_and_records_are_compared_both_ways() -> None:
    from collections import Counter

    found = Counter({("1.1", "a.c"): 2})
    record = {"rule": "1.1", "reason": "", "files": ["a.c"]}
    assert not unrecorded(found, [record])
    assert unrecorded(found, []) == [
        "rule 1.1 is broken in a.c (2 places): mend it, or write a record"
    ]
    assert idle_records(Counter(), [record]) == [
        "the record of rule 1.1 for a.c covers nothing: take it away"
    ]
    varying = {**record, "files": ["a.c", "b.c"], "places_vary": True}
    assert not idle_records(found, [varying])
    assert len(idle_records(Counter(), [varying])) == 2
