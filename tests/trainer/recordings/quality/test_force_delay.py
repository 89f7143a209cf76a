"""The delay of force behind position: found with its uncertainty, or not spoken of."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.presses.structures import recorded

from springpot import Recording, check_recordings
from springpot.host.commands.recordings.check import check_parts
from springpot.trainer.recordings.quality.alignment import estimate_skew, low_pass_delay_s
from springpot.trainer.recordings.quality.cycles import find_cycles
from springpot.trainer.recordings.quality.finding import Finding

TIME_S = np.arange(4000) * 1e-3


def sine(name: str = "a", hz: float = 1.0, lead_rad: float = 0.1) -> Recording:
    phase, noise = 2 * np.pi * hz * TIME_S, np.random.default_rng(2).normal(0, 1, (2, len(TIME_S)))
    position_m = 5e-3 * (1 - np.cos(phase)) + 1e-7 * noise[0]
    force_n = 5 * (1 - np.cos(phase + lead_rad)) + 0.01 * noise[1]
    return Recording(name, position_m, force_n, 1e-3, zero="first")


def findings(kind: str, *recordings: Recording) -> list[Finding]:
    return [found for found in check_recordings(recordings).findings if found.kind == kind]


@pytest.mark.parametrize("skew_ms", [-2, 0, 2, 6])
def test_skew_is_estimated_with_its_uncertainty(skew_ms: int) -> None:
    recordings = []
    for hz in (0.75, 1.0, 2.0, 3.0, 5.0, 8.0):
        lead_rad = 0.06 + 0.01 * np.log(hz) - 2 * np.pi * hz * skew_ms * 1e-3
        recordings.append(sine(f"{hz}", hz, lead_rad))
    skew = estimate_skew([c for c in map(find_cycles, recordings) if c])
    assert abs(skew.delay_s * 1e3 - skew_ms) < skew.uncertainty_s * 1e3
    assert skew.uncertainty_s < 3e-3
    report = check_recordings(recordings)
    assert bool(findings("alignment", *recordings)) == (abs(skew_ms) > 2)
    stated = check_recordings([replace(r, force_delay_s=skew_ms * 1e-3) for r in recordings])
    assert all(finding.kind != "alignment" for finding in stated.findings)
    for metadata in stated.recordings:
        loss = metadata["cycles"]["loss"]
        true_rad = 0.06 + 0.01 * np.log(metadata["cycles"]["frequency_hz"])
        assert abs(loss["angle_rad"] - true_rad) < loss["angle_uncertainty_rad"]
    # Of one frequency nothing can be told, and no loss is quoted.
    alone = check_recordings(recordings[:1])
    assert alone.figures["skew_s"] is None
    assert alone.recordings[0]["cycles"]["loss"] is None
    assert report.recordings[0]["cycles"]["loss"] is not None


def test_loss_is_quoted_of_three_cycles_and_printed_where_it_is_measured() -> None:
    """Beside five recordings that tell the delay, a press of one cycle still has no loss."""
    known = [sine(f"{hz}", hz, 0.06) for hz in (0.75, 1.0, 2.0, 3.0, 5.0)]
    for cycles in (1, 2, 3, 4):
        whole, samples = sine("short"), cycles * 1000
        short = replace(
            whole, position_m=whole.position_m[:samples], force_n=whole.force_n[:samples]
        )
        report = check_recordings([*known, short])
        its = report.recordings[-1]["cycles"]
        assert its["count"] == cycles
        assert (its["loss"] is not None) == (cycles >= 3)
        _, rows = next(part for part in check_parts(report) if not isinstance(part, str))
        for row, figures in zip(rows, report.recordings, strict=True):
            loss = figures["cycles"]["loss"]
            measured = loss and abs(loss["angle_rad"]) >= loss["angle_uncertainty_rad"]
            assert (row[-1] != "-") == bool(measured)
        assert {row[-1] == "-" for row in rows} == {True, False}


def test_a_filter_is_warned_of_with_its_delay() -> None:
    assert low_pass_delay_s(1, 20.0) == pytest.approx(1 / (2 * np.pi * 20))
    assert low_pass_delay_s(3, 20.0) == pytest.approx(2 / (2 * np.pi * 20))
    details = {"load_cell_low_pass_hz": 20.0, "load_cell_low_pass_order": 3}
    filtered = replace(sine(hz=2.0), details=details)
    (found,) = findings("filter", filtered)
    assert "15.9 ms late, 0.2 rad at 2 Hz" in found.so_what
    assert not findings("filter", replace(filtered, force_delay_s=0.0159))
    assert not findings("filter", replace(filtered, details={**details, "aligned_s": 0.0159}))


@pytest.mark.parametrize("late_s", [0.0, 0.0159])
def test_a_filter_is_warned_of_once_and_not_where_the_data_exclude_its_delay(late_s: float) -> None:
    """Position that went through a filter alike, and position that did not."""
    details = {"load_cell_low_pass_hz": 20.0, "load_cell_low_pass_order": 3}
    presses = [
        replace(sine(hz=hz, lead_rad=0.06 - 2 * np.pi * hz * late_s), name=f"{hz}", details=details)
        for hz in (0.75, 1.0, 1.5, 3.0, 6.0)
    ]
    assert len(findings("filter", *presses)) == (late_s > 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("structure", ["left-out-depth", "third-repeat"])
@pytest.mark.parametrize("name", ["bergstrom-boyce", "stiffening-tissue", "mullins",
                                  "poro-viscoelastic", "ecoflex-00-10"])  # fmt: skip
def test_presses_without_a_delay_are_not_said_to_have_one(
    name: str, structure: str, tmp_path: Path
) -> None:
    """The first press of an object that settles loses more than a cycle does, at each speed."""
    rest = "?rest=2" if structure == "third-repeat" else ""
    presses = recorded(f"sim://{name}{rest}", structure, tmp_path / "a")
    assert not findings("alignment", *presses)
