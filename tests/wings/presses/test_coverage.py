"""What recordings cover, and what to record next."""

import numpy as np
import pytest

from springpot.host.wings.presses.coverage import find_coverage
from springpot.trainer.recordings.recording import Recording

DT_S = 1e-3


def press(depth_m: float, speed_mps: float, hold_s: float = 0.0) -> Recording:
    """A ramp in, a hold and a ramp out."""
    ramp = np.arange(0.0, depth_m, speed_mps * DT_S)
    x = np.concatenate([ramp, np.full(round(hold_s / DT_S), depth_m), ramp[::-1]])
    return Recording(f"{depth_m}-{speed_mps}-{hold_s}", x, 300.0 * x, DT_S)


def test_strokes_and_holds_are_counted_where_they_are() -> None:
    found = find_coverage([press(4e-3, 1e-3), press(9e-3, 5e-3), press(9e-3, 2e-2, hold_s=6.0)])
    assert len(found.strokes) == 6
    table = found.table()
    assert [sum(row["strokes"]) for row in table] == [0, 2, 4]
    assert [row["longest_hold_s"] > 5.9 for row in table] == [False, False, True]
    np.testing.assert_allclose(found.speeds_mps[:2], [10**-3.5, 1e-3], rtol=1e-9)
    assert not found.one_speed
    assert found.record_next == ["press to 0 .. 3 mm: no stroke ends there"]


def test_a_hole_of_speeds_and_holds_is_named() -> None:
    found = find_coverage([press(4e-3, 1e-2), press(9e-3, 1e-2)])
    assert found.one_speed
    speeds, hold, depth = found.record_next
    assert "three speeds or more" in speeds
    assert "hold at depth for 5 s or more (longest: 0 s)" in hold
    assert depth.startswith("press to 0 .. 3 mm")


def test_a_slow_turn_is_no_hold() -> None:
    time_s = np.arange(20_000) * DT_S
    x = 5e-3 * (1 - np.cos(2 * np.pi * 0.1 * time_s))
    assert find_coverage([Recording("slow", x, 300.0 * x, DT_S)]).longest_hold_s == 0.0


@pytest.mark.parametrize("air_m", [0.0, 1e-3, 2e-2])
def test_the_way_to_the_surface_is_no_depth_to_press_to(air_m: float) -> None:
    """Nor does it change what is asked for; where the object pulls, there is no such way."""
    presses = []
    for item in (press(4e-3, 1e-2), press(9e-3, 1e-2)):
        away_m = np.arange(-air_m, 0.0, 1e-5)
        x = np.concatenate([away_m, item.position_m, away_m[::-1]])
        presses.append(Recording(item.name, x, 300.0 * np.maximum(x, 0.0), DT_S))
    depths = [row["depth_m"] for row in find_coverage(presses).table()]
    np.testing.assert_allclose(depths, [[0.0, 3e-3], [3e-3, 6e-3], [6e-3, 9e-3]], atol=2e-5)
    pulled = [Recording(p.name, p.position_m, 300.0 * p.position_m, DT_S) for p in presses]
    assert find_coverage(pulled).low_m == pytest.approx(-air_m)
