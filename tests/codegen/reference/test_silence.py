"""Samples that stay away: the C and its reference agree to the bit, and too long is latched."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.c import golden_forces
from support.small import DT_S, scene

from springpot.codegen.arrays import Samples
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.guarding import SILENCE_WORTH
from springpot.codegen.reference.notes import HELD, LATCHED
from springpot.codegen.reference.run import run_reference
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.trial_build import built
from springpot.host.validation.compared import proxy_positions

KINDS = ("hammerstein", "rf-fd", "rbf-fd", "rbf-pv", "boosted-recursive", "rf-history-quantised")
MODES = ("off", "tool", "proxy")
SMOOTH_S = 3e-3
Emitted = tuple[Plan, SceneLibrary]


@cache
def emitted(name: str, mode: str, number: str = "float32", device: str = "estimate") -> Emitted:
    chosen = scene(number=number, mode=mode, smoothing_s=SMOOTH_S if number == "float64" else 0.0)
    chosen = replace(chosen, device=replace(chosen.device, velocity=device))
    plan = make_plan(golden_forces.model(name), chosen)
    with built(plan) as library:
        return plan, library


def strokes(plan: Plan, ticks: int, low: float = 0.1, speed: float = 1.0) -> Samples:
    """In and out between `low` and 0.95 of the trained depth; at the top speed, the trained one."""
    trained = plan.model.trained
    base_m = 0.0 if plan.contact else trained.min_m
    span_m = trained.max_m - base_m
    per_s = 2.0 * speed * trained.max_mps / ((0.95 - low) * span_m)
    wave = 0.5 * (1.0 - np.cos(per_s * DT_S * np.arange(ticks)))
    return np.asarray(base_m + span_m * (low + (0.95 - low) * wave))


def gaps(plan: Plan, ticks: int, seed: int) -> np.ndarray:
    """Whether each tick, (ticks,), has no sample: gaps that are made up for before the next."""
    rng = np.random.default_rng(seed)
    longest = round(plan.watchdog_s / plan.dt_s)
    lost = np.zeros(ticks, dtype=bool)
    i = 150
    while i < ticks - longest:
        gap = int(rng.integers(1, longest + 1))
        lost[i : i + gap] = True
        i += gap + int(gap / SILENCE_WORTH) + int(rng.integers(1, 60))
    return lost


def pressed(found: Emitted, position_m: Samples) -> tuple[np.ndarray, np.ndarray]:
    """Force, N, and notes of the C."""
    plan, library = found
    position = position_m.astype(plan.dtype)
    return Replay(library).run(position, backward_velocity(position, plan.dt_s))


@pytest.mark.parametrize(("number", "mode"), golden_forces.EACH_MODE)
@pytest.mark.parametrize("name", KINDS)
def test_the_reference_gives_the_same_bits(name: str, mode: str, number: str) -> None:
    plan, library = emitted(name, mode, number)
    ticks = 700
    position = strokes(plan, ticks, low=-0.1)
    position[gaps(plan, ticks, 1)] = np.nan
    position = position.astype(plan.dtype)
    velocity = np.zeros_like(position)
    force_n, notes = Replay(library).run(position, velocity)
    expected = run_reference(
        plan, position, velocity, proxy_positions(plan, library, position, velocity)
    )
    np.testing.assert_array_equal(force_n, expected.force_n)
    np.testing.assert_array_equal(notes, expected.notes)
    assert force_n.max() > 0.5 and np.any(notes & HELD)


def test_the_reference_gives_the_same_bits_with_the_devices_own_velocity() -> None:
    plan, library = emitted("hammerstein", "proxy", device="device")
    assert plan.needs_device_velocity
    position = strokes(plan, 700, low=-0.1).astype(plan.dtype)
    velocity = backward_velocity(position, plan.dt_s)
    position[gaps(plan, 700, 2)] = np.nan
    velocity[300:304] = np.inf
    force_n, notes = Replay(library).run(position, velocity)
    expected = run_reference(plan, position, velocity)
    np.testing.assert_array_equal(force_n, expected.force_n)
    np.testing.assert_array_equal(notes, expected.notes)
    assert np.all(notes[300:304] & HELD)


@pytest.mark.parametrize("mode", MODES)
def test_silence_beyond_the_watchdog_is_latched_at_zero(mode: str) -> None:
    found = emitted("hammerstein", mode)
    plan = found[0]
    position = strokes(plan, 400)
    longest = round(plan.watchdog_s / plan.dt_s)
    position[200 : 201 + longest] = np.nan
    force_n, notes = pressed(found, position)
    assert not notes[199 + longest] & LATCHED
    assert np.all(notes[200 + longest :] & LATCHED)
    assert not force_n[220 + longest :].any()
