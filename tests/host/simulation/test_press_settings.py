"""Settings in the URL of a simulated object: sensors, rests between presses, lumps."""

import numpy as np
import pytest
from truth import ObjectMotion

from springpot.codegen.arrays import Samples
from springpot.host.devices.virtual import parse_url
from springpot.host.recording.protocols import inverted_cosine
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
    assert np.array_equal(glitch_m[1:], position_m[1:]) and glitch_m[0] == 0.0
    assert np.array_equal(glitch_n, force_n)


LUMP, PLAIN = (0.010, 0.011), (0.026, 0.004)


def pressed_n(place_m: tuple[float, float], position_m: Samples, substeps: int = 4) -> Samples:
    simulated = parse_url(f"sim://lump?x={place_m[0]}&y={place_m[1]}")
    return ObjectMotion(simulated, 1e-3, substeps).move(position_m)


def held(depth_m: float) -> Samples:
    return np.concatenate([np.linspace(0, depth_m, 100), np.full(4000, depth_m)])


def test_a_lump_is_stiffer_and_relaxes_more_slowly_than_the_ground() -> None:
    lump, plain = (pressed_n(place, held(0.003)) for place in (LUMP, PLAIN))
    assert lump[-1] > 1.5 * plain[-1]
    remains = [(each[600] - each[-1]) / (each[99] - each[-1]) for each in (lump, plain)]
    assert remains[0] > 1.04 * remains[1]


def test_a_press_and_its_return_take_work_and_never_pull() -> None:
    rng = np.random.default_rng(0)
    way = np.cumsum(rng.normal(0, 1e-4, 3000))
    position_m = np.concatenate([way, np.linspace(way[-1], -1e-3, 50)])
    force_n = pressed_n(LUMP, position_m)
    assert force_n.min() > -1e-9 and np.sum(force_n * np.diff(position_m, prepend=0.0)) > 0.0


def test_a_bench_goes_to_another_place_of_a_fresh_object() -> None:
    command_n = inverted_cosine(np.arange(500) / 1000, 5.0, 2.0)
    there = SimulatedBench(parse_url(f"sim://lump?x={LUMP[0]}&y={LUMP[1]}"))
    gone = SimulatedBench(parse_url("sim://lump"))
    gone.go_to(LUMP)
    assert gone.place_m == LUMP
    np.testing.assert_array_equal(gone.press(command_n), there.press(command_n))
