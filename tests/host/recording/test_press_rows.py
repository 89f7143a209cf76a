"""What a press keeps of the loop's rows: finite samples only, and why it ended."""

import numpy as np
import pytest

from springpot.host.native.c_library import COLUMN, empty_rows
from springpot.host.recording.indentation import PressRows


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(
    ("column", "unlocated"), [("position_m", True), ("measured_n", False)]
)  # fmt: skip
def test_samples_that_are_no_numbers_are_not_kept(column: str, unlocated: bool, bad: float) -> None:
    """A journal that held one could be read by nobody."""
    kept = []
    taken = PressRows(10, lambda position_m, _force_n: kept.append(position_m))
    taken.append(empty_rows(4))
    rows = empty_rows(3)
    rows[1, COLUMN[column]] = bad
    taken.append(rows)
    assert taken.unlocated is unlocated
    assert taken.unmeasured is (column == "measured_n" and bool(np.isnan(bad)))
    assert len(np.concatenate(kept)) == len(taken.column("position_m")) == 4 and not taken.full
