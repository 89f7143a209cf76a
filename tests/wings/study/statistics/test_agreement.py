"""Intraclass correlations against the published example and R's psych."""

import numpy as np
import pytest

from springpot.codegen.errors import DataError
from springpot.host.wings.study.statistics.agreement import intraclass

# Shrout and Fleiss (1979), table 2: six targets, four judges
SHROUT_FLEISS = np.array([
    [9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7],
], dtype=float)  # fmt: skip


def test_shrout_and_fleiss_as_published_and_as_psych() -> None:
    absolute, consistent, average = intraclass(SHROUT_FLEISS)
    assert [round(x.value, 2) for x in (absolute, consistent, average)] == [0.29, 0.71, 0.91]
    expected = [(0.289764, 0.0187865, 0.761084), (0.714841, 0.3424648, 0.945858),
                (0.909316, 0.6756747, 0.985892)]  # fmt: skip  # psych::ICC(lmer = FALSE)
    for ours, theirs in zip((absolute, consistent, average), expected, strict=True):
        assert (ours.value, ours.low, ours.high) == pytest.approx(theirs, abs=1e-6)


def test_what_has_no_agreement_is_refused() -> None:
    with pytest.raises(DataError, match="2 targets in 4 sessions"):
        intraclass(SHROUT_FLEISS[:2])
    with pytest.raises(DataError, match="no meaning"):
        intraclass(np.ones((5, 3)))


@pytest.mark.slow
def test_intervals_hold_the_truth_in_93_to_97_percent() -> None:
    rng = np.random.default_rng(4)
    held = np.zeros(3)
    for _ in range(1000):
        shift = 0.5 * rng.normal(size=3)  # of sessions, half the noise of a score
        scores = rng.normal(0.0, 2.0, (20, 1)) + shift + rng.normal(size=(20, 3))
        truth = (4 / 5.25, 4 / 5, 12 / 13)
        held += [x.low <= t <= x.high for x, t in zip(intraclass(scores), truth, strict=True)]
    assert np.all(held >= 930), held
    assert np.all(held <= 970), held
