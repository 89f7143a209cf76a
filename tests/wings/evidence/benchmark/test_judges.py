"""The judges' cells: what is stored stays, a failure is a result, the floor is the sensors'."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest
from support.paths import BENCH

sys.path.append(str(BENCH))  # as where the script is run
import judges

CELL = judges.Cell("dragon-skin-10", "one-speed")


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Kinds that were measured; rbf-fd fails."""
    found: list[str] = []

    def measured(kind: str, *_: Any) -> dict[str, Any]:
        found.append(kind)
        if kind == "rbf-fd":
            raise ValueError("no such pair")
        return {"percent": 1.0, "tick_ns": 20.0}

    monkeypatch.setattr(judges, "measured", measured)
    return found


def test_what_is_stored_is_not_computed_again(
    tmp_path: Path, calls: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "cells").mkdir()
    found = judges.judged(CELL, tmp_path)
    assert calls[-1] == "auto"
    assert set(found["models"]) >= {"hammerstein", "auto"}
    assert found["models"]["rbf-fd"]["failed"] == "ValueError: no such pair"
    assert json.loads(CELL.stored(tmp_path).read_text()) == found
    once = len(calls)
    assert judges.judged(CELL, tmp_path) == found
    assert len(calls) == once
    # Ended in the middle: only what is missing.
    half = {name: value for name, value in found.items() if name != "complete"}
    del half["models"]["auto"]
    judges.write(CELL, tmp_path, half)
    assert judges.judged(CELL, tmp_path)["complete"]
    assert calls[once:] == ["auto"]
    # Other code: all of it.
    monkeypatch.setattr(judges, "code_hash", lambda: "other")
    judges.judged(CELL, tmp_path)
    assert len(calls) == 2 * once + 1


def test_the_floor_is_what_the_sensors_add() -> None:
    training, test, floor_n = judges.recorded("dragon-skin-10", "one-speed")
    assert [len(recording.force_n) for recording in training] == [4000] * 3
    assert len(test) == 3
    # 15 mN of the load cell, and some 4 um of the encoder on up to 4 N/mm.
    assert 0.015 < floor_n < 0.03
    _, _, drifting_n = judges.recorded("dragon-skin-10", "one-long")
    assert floor_n < drifting_n < 0.05  # 0.1 N a minute over 15 s is 14 mN RMS
