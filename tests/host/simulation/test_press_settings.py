"""What a URL of a simulated object says of its sensors, and of the rest between presses."""

import numpy as np
import pytest

from springpot.host.devices.virtual import parse_url
from springpot.host.simulation.bench import SimulatedBench

HALF_S = 0.5 * 10 * (1 - np.cos(2 * np.pi * 2 * np.arange(500) / 1000))


def test_a_rested_object_remembers_and_a_fresh_one_does_not() -> None:
    depths_m = {}
    for query in ("", "?rest=1"):
        bench = SimulatedBench(parse_url(f"sim://mullins{query}"))
        depths_m[query] = [bench.press(0.5 * HALF_S)[0].max()]
        bench.press(HALF_S)
        depths_m[query].append(bench.press(0.5 * HALF_S)[0].max())
    fresh, rested = depths_m[""], depths_m["?rest=1"]
    assert fresh[1] == pytest.approx(fresh[0], abs=3e-5)
    assert rested[1] > rested[0] + 5e-4  # damaged by the deep press between


def test_rate_drift_and_glitch_change_what_is_kept_alone() -> None:
    def pressed(query: str) -> tuple[np.ndarray, np.ndarray]:
        taken: list[tuple[np.ndarray, np.ndarray]] = []
        bench = SimulatedBench(parse_url(f"sim://ecoflex-00-50{query}"))
        position_m, force_n = bench.press(HALF_S, lambda x, f: taken.append((x, f)))
        assert np.array_equal(np.concatenate([x for x, _ in taken]), position_m)
        return position_m, force_n

    position_m, force_n = pressed("")
    for rate_hz in (500, 50, 8):
        slow_m, slow_n = pressed(f"?rate={rate_hz}")
        assert np.array_equal(slow_m, position_m[:: 1000 // rate_hz])
        assert np.array_equal(slow_n, force_n[:: 1000 // rate_hz])
    drifted_m, drifted_n = pressed("?drift=0.6")
    assert np.array_equal(drifted_m, position_m)
    assert drifted_n - force_n == pytest.approx(1e-5 * np.arange(500))
    glitch_m, glitch_n = pressed("?glitch=1")
    assert np.array_equal(glitch_m[1:], position_m[1:])
    assert glitch_m[0] == 0.0
    assert np.array_equal(glitch_n, force_n)
