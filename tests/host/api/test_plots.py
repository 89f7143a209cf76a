"""`.plot()` of results: on the axes that are given, on new ones, and without matplotlib."""

import sys
from collections.abc import Iterator

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from support.small import training

from springpot.codegen.errors import UsageError


@pytest.fixture(autouse=True)
def no_figure_stays() -> Iterator[None]:
    yield
    pyplot.close("all")


def test_a_recording_is_force_against_position(monkeypatch: pytest.MonkeyPatch) -> None:
    one = training()[0]
    axes = pyplot.figure().subplots()
    assert one.plot(axes) is axes
    np.testing.assert_array_equal(axes.lines[0].get_xydata().T, [1e3 * one.position_m, one.force_n])
    assert isinstance(one.plot(), Axes)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(UsageError, match=r"pip install 'springpot\[report\]'"):
        one.plot()
