"""Spikes of position: what is held, what is a motion, and what a fit says of it."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from support.small import DT_S, press, recording, soft_force

from springpot import Recording, check_recordings
from springpot.codegen.errors import DataError
from springpot.host.metrics import accuracy
from springpot.host.validation.seen import seen_by
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.compatibility import require_compatible
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.predict import predict_n
from springpot.trainer.models.training_set import training_set
from springpot.trainer.recordings.quality.spikes import hold_spikes
from springpot.trainer.recordings.recording_file import write_recording

CYCLES = 0.006 + press(1.0, 0.004, 3)


def preloaded(hz: float) -> Recording:
    position_m = 0.006 + press(hz, 0.004, 3)
    return Recording(f"{hz}", position_m, 1.0 + soft_force(position_m), DT_S)


def spoiled(item: Recording, rows: list[int], to_m: float) -> Recording:
    position_m = item.position_m.copy()
    position_m[rows] = to_m
    return dataclasses.replace(item, position_m=position_m)


@pytest.mark.parametrize(
    "rows", [[0], [0, 1, 2], [700], [700, 701, 702, 703, 704], [2999], [5, 700, 702, 1900]]
)
@pytest.mark.parametrize("to_m", [0.0, 0.03, -5.0])
def test_a_spike_is_held_and_counted(rows: list[int], to_m: float) -> None:
    item = preloaded(1.0)
    held, (finding,) = hold_spikes(spoiled(item, rows, to_m))
    assert f"{len(rows)} of 3000 samples of position" in finding.what
    np.testing.assert_allclose(held.position_m, item.position_m, atol=6e-5)
    assert held.force_n is item.force_n


def test_a_report_gives_what_it_read_and_judges_it_without_spikes(tmp_path: Path) -> None:
    item = spoiled(preloaded(1.0), [700], 0.03)
    write_recording(tmp_path / "a.h5", item)
    report = check_recordings([tmp_path])
    assert [each.content_hash for each in report.given] == [item.content_hash]
    assert report.checked[0].position_m.max() < 0.02


@pytest.mark.parametrize("to_n", [900.0, -40.0])
def test_a_spike_of_force_is_held_and_sets_no_limit(to_n: float) -> None:
    rows = [40, 300, 301, 1900]
    clean = recording("a", press(1.0, 0.01, 3))
    force_n = clean.force_n.copy()
    force_n[rows] = to_n
    item = dataclasses.replace(clean, force_n=force_n)
    held, (finding,) = hold_spikes(item)
    assert f"{len(rows)} of 3000 samples of force jump away, the first at" in finding.what
    np.testing.assert_allclose(held.force_n, clean.force_n, atol=0.2)
    assert training_set([item], 0.0).trained.max_n == pytest.approx(clean.force_n.max())
    report = check_recordings([item])
    assert [found.kind for found in report.findings] == [
        "outlier", *(found.kind for found in check_recordings([clean]).findings)
    ]  # fmt: skip
    assert report.recordings[0]["force_n"] == pytest.approx(
        [clean.force_n.min(), clean.force_n.max()]
    )


def test_a_row_of_zeros_before_a_preload_turns_no_sign_round() -> None:
    """The logger had not begun: position falls and force rises, which no object does."""
    whole = preloaded(1.0)
    force_n = np.append(0.0, whole.force_n + 10.0)
    for at_m in (0.02, 0.2, 0.07):
        position_m = np.append(0.0, whole.position_m - at_m)
        zeros = dataclasses.replace(whole, position_m=position_m, force_n=force_n)
        report = check_recordings([zeros])
        assert not report.refused
        assert report.findings[0].kind == "outlier"
        assert report.signs[0].right


def test_what_a_tool_did_is_no_spike() -> None:
    time_s, rest = np.arange(3000) * DT_S, np.zeros(3000)
    struck = np.maximum(0.0, 0.5 * np.minimum(time_s - 1.0, 0.02)) * (time_s > 1.0)
    impact_n = soft_force(struck) + 60.0 * np.exp(-(((time_s - 1.003) / 0.001) ** 2))
    sudden = rest + 0.005 * (np.arange(3000) > 2)  # three samples before a sudden press
    tap = rest + 0.005 * ((np.arange(3000) >= 400) & (np.arange(3000) < 406))  # six samples
    stairs = rest + 0.002 * (np.arange(3000) > 700) + 0.002 * (np.arange(3000) > 702)
    motions = (CYCLES, sudden, tap, stairs, press(200.0, 0.01, 200), rest[:2])
    pairs = [(position_m, soft_force(position_m)) for position_m in motions]
    pairs += [(struck, impact_n), (rest + 0.005, 5.0 + 30.0 * np.exp(-time_s / 0.0005))]
    for position_m, force_n in pairs:
        item = Recording("x", position_m, force_n, DT_S)
        assert hold_spikes(item) == (item, [])


def test_a_first_sample_far_off_spoils_no_fit() -> None:
    presses = [preloaded(hz) for hz in (0.5, 1.0, 4.0)]
    presses[1] = spoiled(presses[1], [0], 0.03)
    fit = fit_model("hammerstein", "x", presses, FitOptions(smooth_s=0.0))
    assert fit.model.trained.max_m == pytest.approx(0.01)
    assert sum("1.0: 1 of 3000 samples" in line for line in fit.warnings) == 1
    test = preloaded(2.0)
    found = accuracy([test.force_n], [predict_n(fit.model, test)])
    assert found.rmse_percent_of_peak < 1.3  # with the spike: 4.2
    assert seen_by(fit.model, presses) == 3


def test_force_at_the_lowest_depth_says_whether_there_is_a_surface() -> None:
    assert training_set([recording("a", press(1.0, 0.01))], 0.0).contact == "surface"
    data = training_set([preloaded(1.0)], 0.0)
    assert data.contact == "always"
    assert any("no recording leaves the object" in line for line in data.warnings)
    air = np.maximum(press(1.0, 0.012, 2) - 0.002, 0.0)
    tare = Recording("tare", press(1.0, 0.012, 2) - 0.002, 0.5 + soft_force(air), DT_S)
    assert training_set([tare], 0.0).contact == "surface"  # nothing pushes in free air


def test_a_preloaded_objects_model_takes_its_recordings_and_no_others() -> None:
    presses = [preloaded(hz) for hz in (0.5, 1.0, 4.0)]
    model = fit_model("hammerstein", "x", presses, FitOptions()).model
    assert model.contact == "always"
    require_compatible(preloaded(2.0), model)
    moved = dataclasses.replace(preloaded(2.0), zero="min")
    with pytest.raises(DataError, match="without --zero first or min: import all the same way"):
        require_compatible(moved, model)
