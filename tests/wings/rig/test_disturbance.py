"""A drifting load cell and a hum are named; objects that relax, recover and vibrate are not."""

import numpy as np
import pytest
from scipy.signal import lfilter
from support.files.recording_files import PressedObject

from springpot.host.wings.rig.disturbance import drift_findings, hum_of
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
