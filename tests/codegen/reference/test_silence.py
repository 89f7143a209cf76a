"""Samples that stay away: the C and its reference agree to the bit, and too long is latched."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.c import golden_forces
from support.c.same_bits import require_same_bits
from support.small import DT_S, scene

from springpot.codegen.arrays import Samples
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.make_plan import make_plan
from springpot.codegen.notes import HELD, LATCHED
from springpot.codegen.plan import Plan
from springpot.codegen.tool_motion import SILENCE_WORTH

KINDS = ("hammerstein", "rf-fd", "rbf-fd", "rbf-pv", "rbf-pv averaged", "rf-fd-long",
         "rf-history-quantised")  # fmt: skip
MODES = ("off", "tool", "proxy")
SMOOTH_S = 3e-3


@cache
def plan_of(name: str, mode: str, number: str = "float32", device: str = "estimate") -> Plan:
    chosen = scene(number=number, mode=mode, smoothing_s=SMOOTH_S if number == "float64" else 0.0)
    chosen = replace(chosen, device=replace(chosen.device, velocity=device))
    model = golden_forces.model(name.removesuffix(" averaged"))
    if name.endswith("averaged"):
        model = replace(model, features=replace(model.features, weight=0.7))
    return make_plan(model, chosen)


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


@pytest.mark.few(1)
@pytest.mark.parametrize(("number", "mode"), golden_forces.EACH_MODE)
@pytest.mark.parametrize("name", KINDS)
def test_the_reference_gives_the_same_bits(name: str, mode: str, number: str) -> None:
    plan = plan_of(name, mode, number)
    position = strokes(plan, 700, low=-0.1)
    position[gaps(plan, 700, 1)] = np.nan
    force_n, notes = require_same_bits(plan, position, np.zeros(700, plan.dtype))
    assert force_n.max() > 0.5 and np.any(notes & HELD)


def test_the_reference_gives_the_same_bits_with_the_devices_own_velocity() -> None:
    plan = plan_of("hammerstein", "proxy", device="device")
    assert plan.needs_device_velocity
    position = strokes(plan, 700, low=-0.1).astype(plan.dtype)
    velocity = backward_velocity(position, plan.dt_s)
    position[gaps(plan, 700, 2)] = np.nan
    velocity[300:304] = np.inf
    _, notes = require_same_bits(plan, position, velocity, find=True)
    assert np.all(notes[300:304] & HELD)


@pytest.mark.few(1)
@pytest.mark.parametrize("mode", MODES)
def test_silence_beyond_the_watchdog_is_latched_at_zero(mode: str) -> None:
    plan = plan_of("hammerstein", mode)
    position = strokes(plan, 400)
    longest = round(plan.watchdog_s / plan.dt_s)
    position[200 : 201 + longest] = np.nan
    force_n, notes = require_same_bits(plan, position)
    assert not notes[199 + longest] & LATCHED
    assert np.all(notes[200 + longest :] & LATCHED)
    assert not force_n[220 + longest :].any()
