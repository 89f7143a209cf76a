"""Validation on training recordings is noticed by their samples, and said before any figure."""

from dataclasses import replace

import pytest
from support.small import press, recording, training

from springpot import Recording, check_recordings
from springpot.host.validation.seen import seen_by
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

NEW = recording("new", press(1.7, 0.01))


def renamed(item: Recording) -> Recording:
    return replace(item, name=f"my-{item.name}", source="another folder")


def cut(item: Recording) -> Recording:
    return replace(item, position_m=item.position_m[10:], force_n=item.force_n[10:])


@pytest.mark.few(1)
@pytest.mark.parametrize("smooth_s", [0.0, 0.025])
def test_a_name_hides_nothing_and_a_cut_cannot_be_known(smooth_s: float) -> None:
    """Also where the fit saw the recordings smoothed."""
    model = fit_model("hammerstein", "m", training(), FitOptions(smooth_s=smooth_s)).model
    assert seen_by(model, [training()[0], renamed(training()[1]), NEW]) == 2
    assert seen_by(model, [cut(training()[0])]) == 0


def test_two_training_recordings_of_one_name_are_both_seen() -> None:
    """Folders of two days may hold the same names."""
    twins = [replace(item, name="press") for item in training()[:2]]
    model = fit_model("hammerstein", "x", [*twins, *training()[2:4]], FitOptions()).model
    assert seen_by(model, twins) == 2
    assert len(check_recordings(twins).recordings) == 2
    speeds = {figures["max_speed_mps"] for figures in check_recordings(twins).recordings}
    assert len(speeds) == 2
