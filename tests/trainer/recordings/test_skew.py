"""The delay of force behind position: found with its uncertainty, or not spoken of."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.presses.structures import recorded

from springpot import Recording, check_recordings

TIME_S = np.arange(4000) * 1e-3


def sine(name: str, hz: float, lead_rad: float) -> Recording:
    phase, noise = 2 * np.pi * hz * TIME_S, np.random.default_rng(2).normal(0, 1, (2, len(TIME_S)))
    position_m = 5e-3 * (1 - np.cos(phase)) + 1e-7 * noise[0]
    force_n = 5 * (1 - np.cos(phase + lead_rad)) + 0.01 * noise[1]
    return Recording(name, position_m, force_n, 1e-3, zero="first")


@pytest.mark.parametrize("skew_ms", [-2, 0, 2, 6])
def test_skew_is_estimated_with_its_uncertainty(skew_ms: int) -> None:
    recordings = []
    for hz in (0.75, 1.0, 2.0, 3.0, 5.0, 8.0):
        lead_rad = 0.06 + 0.01 * np.log(hz) - 2 * np.pi * hz * skew_ms * 1e-3
        recordings.append(sine(f"{hz}", hz, lead_rad))
    report = check_recordings(recordings)
    assert abs(report.skew.delay_s * 1e3 - skew_ms) < report.skew.uncertainty_s * 1e3
    assert report.skew.uncertainty_s < 3e-3
    found = [finding for finding in report.findings if finding.kind == "alignment"]
    assert bool(found) == (abs(skew_ms) > 2)
    stated = check_recordings([replace(r, force_delay_s=skew_ms * 1e-3) for r in recordings])
    assert "alignment" not in {finding.kind for finding in stated.findings}
    for metadata in stated.recordings:
        loss = metadata["cycles"]["loss"]
        true_rad = 0.06 + 0.01 * np.log(metadata["cycles"]["frequency_hz"])
        assert abs(loss["angle_rad"] - true_rad) < loss["angle_uncertainty_rad"]
    # Of one frequency nothing can be told, and no loss is quoted.
    alone = check_recordings(recordings[:1])
    assert alone.skew is None
    assert alone.recordings[0]["cycles"]["loss"] is None


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
    assert "alignment" not in {found.kind for found in check_recordings(presses).findings}
