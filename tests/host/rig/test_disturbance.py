"""A drifting load cell and a hum are named; objects that relax, recover and vibrate are not."""

import numpy as np
import pytest
from scipy.signal import lfilter
from support.files.recording_files import PressedObject

from springpot import check_recordings
from springpot.host.rig.disturbance import drift_findings, hum_of
from springpot.trainer.recordings.recording import Recording

DT_S = 0.005
TIME_S = np.arange(0.0, 20.0, DT_S)
NOISE_N = np.random.default_rng(3).normal(0.0, 0.005, len(TIME_S))
CYCLES_M = 0.004 * (1.0 - np.cos(2.0 * np.pi * 0.4 * TIME_S))
# A deep press, then shallow ones: what the deep one took comes back, and force at rest rises.
RECOVERING_M = CYCLES_M * np.where(TIME_S < 7.5, 1.0, 0.3)


def recorded(position_m: np.ndarray, added_n: np.ndarray, offset_m: float = 0.0) -> Recording:
    force_n = PressedObject(0.008, 5.0).force(position_m + offset_m, DT_S) + NOISE_N
    return Recording("press", position_m, force_n + added_n, DT_S)


@pytest.mark.parametrize("position_m", [CYCLES_M, RECOVERING_M])
@pytest.mark.parametrize("offset_m", [0.0, -0.001, 0.002])
def test_memory_is_no_drift(position_m: np.ndarray, offset_m: float) -> None:
    """Pressed from the surface, from air, and from within the object."""
    assert not list(drift_findings(recorded(position_m, 0.0 * TIME_S, offset_m)))


@pytest.mark.parametrize("rate_nps", [0.05, -0.05])
@pytest.mark.parametrize("offset_m", [0.0, -0.001])
def test_drift_either_way_is_named(rate_nps: float, offset_m: float) -> None:
    for position_m in (CYCLES_M, RECOVERING_M):
        (found,) = drift_findings(recorded(position_m, rate_nps * TIME_S, offset_m))
        assert "the load cell does" in found.text


def zeroed_under_load(seed: int) -> tuple[Recording, float]:
    """A relaxing object on a preload where both channels were zeroed, and its force there."""
    draw = np.random.default_rng(seed)
    depth_m = 0.008 * (0.3 + 0.7 * CYCLES_M / CYCLES_M.max())
    way_in_m = np.linspace(0.0, depth_m[0], round(draw.uniform(0.1, 0.5) / DT_S))
    elastic_n = 5.0 * (np.concatenate([way_in_m, depth_m]) / 0.008) ** draw.uniform(1.2, 2.2)
    keep = np.exp(-DT_S / 10.0 ** draw.uniform(0.0, 1.7))
    relaxed_n = draw.uniform(0.3, 0.8) * lfilter([1.0 - keep], [1.0, -keep], elastic_n)
    force_n = np.maximum(elastic_n - relaxed_n, 0.0)[len(way_in_m) :] + NOISE_N
    taken_n = float(force_n[:5].mean())
    return Recording("zeroed", depth_m - depth_m[0], force_n - taken_n, DT_S), taken_n


def test_an_object_that_was_zeroed_under_load_is_named_beside_the_load_cell() -> None:
    """Its force falls below 0 as it relaxes; with the force that was taken off it falls to 0.

    Where it has fallen at once, force is level: no line is the cause, and the contact is checked.
    """
    named = remedied = 0
    for seed in range(30):
        recording, taken_n = zeroed_under_load(seed)
        to_do = [found.to_do for found in check_recordings([recording]).findings]
        remedied += any("--tare" in each for each in to_do)
        for found in drift_findings(recording):
            assert "no object" not in found.text
            assert "--tare=-PRELOAD_N" in found.to_do and "tare before each" in found.to_do
            named += 1
        tared = Recording("tared", recording.position_m, recording.force_n + taken_n, DT_S)
        assert not list(drift_findings(tared))
    assert named >= 6 and remedied >= 28


@pytest.mark.parametrize("offset_m", [-0.001, -0.002])
def test_a_drift_in_the_air_is_the_load_cells_alone(offset_m: float) -> None:
    for rate_nps in (0.02, -0.02):
        (found,) = drift_findings(recorded(CYCLES_M, rate_nps * TIME_S, offset_m))
        assert "no object does that" in found.text
        assert "PRELOAD" not in found.text


@pytest.mark.parametrize("share", [0.3, 0.6])
@pytest.mark.parametrize("tau_s", [1.0, 4.0])
def test_what_holds_the_tool_pulls_it_ever_more_and_is_no_drift(share: float, tau_s: float) -> None:
    """A bonded specimen that is pressed for longer and longer relaxes, and pulls at strain 0."""
    ends_s = [0.0, 1.0, 2.0, 3.0, 4.0, 5.5, 6.0, 7.0, 10.0, 11.0, 12.0, 18.0, 19.0, 20.0]
    low, high = [0.0, 0.0], [4e-3, 4e-3]
    depths_m = [*low, *high, *low, *high, 4e-3, 0.0, *high, *low]
    depth_m = np.interp(TIME_S, ends_s, depths_m)
    relaxed_m = lfilter([1.0 - np.exp(-DT_S / tau_s)], [1.0, -np.exp(-DT_S / tau_s)], depth_m)
    force_n = 2e3 * (depth_m - share * relaxed_m) + NOISE_N
    assert force_n.min() < -0.1
    assert not list(drift_findings(Recording("bonded", depth_m, force_n, DT_S)))


def test_what_is_pulled_relaxes_upwards() -> None:
    pressed = recorded(CYCLES_M, 0.0 * TIME_S)
    pulled = Recording(
        "pull", -pressed.position_m, 0.2 * TIME_S[::-1] / 20.0 - pressed.force_n, DT_S
    )
    assert not list(drift_findings(pulled))


def test_a_hum_is_found_and_what_the_tool_does_is_none() -> None:
    hum_n = 0.1 * np.sin(2.0 * np.pi * 50.1 * TIME_S)
    found = hum_of(recorded(CYCLES_M, hum_n))
    assert found == pytest.approx((50.1, 0.1), rel=0.1)
    assert hum_of(recorded(CYCLES_M, 0.0 * TIME_S)) is None
    shaken_m = CYCLES_M + 1e-4 * np.sin(2.0 * np.pi * 50.1 * TIME_S)
    assert hum_of(recorded(shaken_m, 0.0 * TIME_S)) is None
