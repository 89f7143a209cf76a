"""The account of energy, however time is told: late, in parts, or with a hand that rests.

Motions are given, as by a hand that no force turns; the C gives the forces.
"""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from codegen.reference.test_energy_returned import SHARE, emitted, force_on, motion, paid_j, stroke
from support.c import golden_forces
from support.small import DT_S

from springpot.basics import Samples
from springpot.host.native.scene_library import SceneState

FREQUENCY_HZ, PER_CYCLE, LENGTH = 10.0, 100, 12  # of presses; ticks of a hitch
KINDS = ["hammerstein", *(pytest.param(name, marks=pytest.mark.slow)
                          for name in golden_forces.models() if name != "hammerstein")]  # fmt: skip

# What a loop does at a tick: positions as they are seen, with the force that is held from then on.
Loop = Callable[[SceneState, Samples, int], Iterator[tuple[float, float]]]


def given_j(seen: list[tuple[float, float]]) -> Samples:
    """Work of the hand up to each position, J: the force before it was held up to there."""
    position_m, force_n = map(np.array, zip(*seen, strict=True))
    return paid_j(force_n, position_m)


def late_steps(state: SceneState, position_m: Samples, begin: int) -> Iterator[tuple[float, float]]:
    """sp_step_dt, one of it late."""
    for at in [*range(begin), *range(begin + LENGTH, len(position_m))]:
        dt_s = (LENGTH + 1) * DT_S if at == begin + LENGTH else DT_S
        yield position_m[at], state.step_dt(dt_s, position_m[at])[0]


def idle_after(state: SceneState, position_m: Samples, begin: int) -> Iterator[tuple[float, float]]:
    """One sp_idle for all of the hitch, once it is over."""
    for at in [*range(begin), *range(begin + LENGTH, len(position_m))]:
        if at == begin + LENGTH:
            state.idle(LENGTH * DT_S)
        yield position_m[at], state.step(position_m[at])[0]


@pytest.mark.parametrize("loop", [late_steps, idle_after])
@pytest.mark.parametrize("phase", [0.5, 0.58, 0.66, 0.71, 0.8])
@pytest.mark.parametrize("name", KINDS)
def test_what_one_late_call_gave_is_owed_by_the_next_presses(
    name: str, phase: float, loop: Loop
) -> None:
    """A device holds its force while nobody calls: that press may give, all together may not."""
    plan, library = emitted(name, "off")
    if loop is late_steps and not plan.any_rate:
        pytest.skip("has no sp_step_dt")
    press_m = stroke(plan, FREQUENCY_HZ, 1)[:PER_CYCLE]
    press_j = paid_j(
        force_on(library, stroke(plan, FREQUENCY_HZ, 1)), stroke(plan, FREQUENCY_HZ, 1)
    )
    state = library.new_state()
    seen: list[tuple[float, float]] = []
    for _ in range(24):
        seen += list(loop(state, press_m, round(phase * PER_CYCLE)))
    work_j = given_j(seen).reshape(24, -1).min(axis=1)
    held_n, position_m = np.array(seen[:PER_CYCLE]).T[1], press_m
    begin = round(phase * PER_CYCLE)
    out_m = position_m[begin - 1] - position_m[begin + LENGTH]
    once_j = max(held_n[begin - 1] * out_m, 0.0)
    assert -work_j[12:].min() <= -work_j[:12].min() + once_j + SHARE * press_j.max()
    assert -work_j.min() <= press_j.max()


@pytest.mark.parametrize("parts", [1, 2, 3, 4, 10])
@pytest.mark.parametrize("name", KINDS)
def test_a_silence_told_in_parts_of_ticks_gives_no_energy(name: str, parts: int) -> None:
    plan, library = emitted(name, "off")
    position_m = stroke(plan, FREQUENCY_HZ, 3)
    press_j = paid_j(force_on(library, position_m), position_m)[:PER_CYCLE].max()
    grid = np.arange(len(position_m))
    for begin in range(PER_CYCLE, 2 * PER_CYCLE, 7):
        for length in (3, 11, 18):
            state, seen = library.new_state(), []
            for at in grid[:begin]:
                seen.append((position_m[at], state.step(position_m[at])[0]))
            for at in begin - 1 + np.arange(1, length * parts + 1) / parts:
                seen.append((np.interp(at, grid, position_m), state.idle(DT_S / parts)[0]))
            for at in grid[begin + length :]:
                seen.append((position_m[at], state.step(position_m[at])[0]))
            assert -given_j(seen).min() <= SHARE * press_j


@pytest.mark.parametrize("smoothing_s", [0.0, 0.002, 0.005, 0.02])
@pytest.mark.parametrize("mode", ["off", pytest.param("proxy", marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", KINDS)
def test_the_force_of_a_hand_that_rests_is_as_steady_as_without_the_account(
    name: str, mode: str, smoothing_s: float
) -> None:
    """Whatever it did before, with samples lost or not: steps of the encoder are no motion."""
    plan, library = emitted(name, mode, "account", smoothing_s)
    _, bare = emitted(name, mode, "off", smoothing_s)
    for seed in range(12):
        rng = np.random.default_rng(seed)
        way_m = motion(plan, rng.random(8))[:-80]
        way_m = way_m[: len(way_m) - int(rng.integers(0, 200))]
        position_m = np.concatenate([way_m, np.full(900, way_m[-1])])
        noisy_m = position_m + rng.normal(0.0, 3e-6, len(position_m))
        position_m = 1e-5 * np.round(1e5 * noisy_m)  # device.resolution_um; to and fro by two
        lost = np.zeros(len(position_m), dtype=bool)
        if seed % 2:
            begin = int(rng.integers(20, len(way_m) - 20))
            lost[begin : begin + int(rng.integers(3, 18))] = True
        steps_n = [
            np.abs(np.diff(force_on(each, position_m, lost)[-600:])).max()
            for each in (library, bare)
        ]
        assert steps_n[0] <= steps_n[1] + 0.02
