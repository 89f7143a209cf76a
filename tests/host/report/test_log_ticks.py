"""Logarithmic axes: their labels are numbers that one reads, and neither few nor many."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from springpot.host.pages.plot_style import log_ticks


@pytest.mark.parametrize("low", [1.3e-4, 0.012, 0.7, 36.0, 6e4])
@pytest.mark.parametrize("decades", [0.03, 0.4, 1.2, 2.5, 3.9, 5.0])
def test_labels_are_plain_numbers_within_the_axis(low: float, decades: float) -> None:
    axes = Figure(figsize=(4.4, 3.0)).subplots()
    axes.semilogx([low, low * 10.0**decades], [0.0, 1.0])
    log_ticks(axes.xaxis)
    left, right = axes.get_xlim()
    ticks = [
        (at, text.get_text())
        for at, text in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
        if left <= at <= right
    ]
    assert 2 <= len(ticks) <= 10, ticks
    assert np.all(np.diff([at for at, _ in ticks]) > 0.0)
    if left < 1e-4 or right > 1e7:
        assert all("10^" in text for _, text in ticks)  # long as plain numbers
    else:
        assert [float(text) for _, text in ticks] == pytest.approx([at for at, _ in ticks])
        assert not any("e" in text for _, text in ticks)
