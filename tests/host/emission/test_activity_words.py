"""Words of emission on a model that gives energy: only if it does."""

from types import SimpleNamespace

import pytest

from springpot.host.emission.emission import _activity


@pytest.mark.parametrize("inside", [0, 3])
@pytest.mark.parametrize("outside", [0, 1])
def test_only_cells_that_give_energy_are_counted(inside: int, outside: int) -> None:
    counts = {False: (inside, 30), True: (outside, 18)}
    told = " ".join(_activity(SimpleNamespace(model_map=SimpleNamespace(active=counts.get))))
    assert " 0 of" not in told
    assert ("3 of 30 small-signal cells" in told) == (inside > 0)
    assert ("1 of 18 small-signal cells beyond the trained depth" in told) == (outside > 0)
