"""Vibration on a hold: its size from 0.5 Hz on, whether it grows, what the check makes of it."""

import dataclasses
import re

import numpy as np
import pytest
from support.c import golden_forces
from support.silicones import paper_presses
from support.small import scene

from springpot import Model, Scene
from springpot.codegen.coupling.linear_loop import DESIGN_HAND, HAND_MODELS, Hand
from springpot.codegen.errors import UnsafeError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.plan import Plan
from springpot.codegen.scene import Device
from springpot.host.native.scene_library import built
from springpot.host.simulation.cases import HOLDS, NUDGE_N, NUDGE_S, cases, held_case
from springpot.host.simulation.scenarios import Workspace, holding, pressing
from springpot.host.stability.check import stability
from springpot.host.stability.closed_loop import (
    Outcome,
    band_rms,
    case_outcome,
    rendered,
    vibration_of,
)
from springpot.host.stability.linear import scene_loop
from springpot.host.stability.verdict import Fault, Grade, judge
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

DT_S, HOLD_S = 1e-3, 11.5
LIGHT = HAND_MODELS[2]
# The design hand holds it, and the light one swings it up, at 3 Hz.
HEAVY = Device(mass_kg=2.0, viscous_nspm=0.5, delay_samples=2)


def swinging(growth_per_s: float, size_mps: float = 5e-3, frequency_hz: float = 4.5) -> np.ndarray:
    time_s = np.arange(round(HOLD_S / DT_S)) * DT_S
    return size_mps * np.exp(growth_per_s * time_s) * np.sin(2 * np.pi * frequency_hz * time_s)


@pytest.mark.parametrize("growth_per_s", [-0.5, 0.0, 0.05, 0.2, 1.0])
def test_even_growth_is_that_of_two_thirds_of_a_hold(growth_per_s: float) -> None:
    found = vibration_of([swinging(growth_per_s)], DT_S)
    ratio = np.exp(growth_per_s * HOLD_S * 2.0 / 3.0)
    assert found.growth_ratio == pytest.approx(
        max(ratio, found.growth_ratio * (ratio < 1)), rel=0.02
    )
    assert found.grows is (growth_per_s > 0.1)


@pytest.mark.parametrize("frequency_hz", [0.8, 2.0, 4.5, 14.0])
def test_slow_vibration_has_its_size(frequency_hz: float) -> None:
    found = vibration_of([swinging(0.0, 1e-4), swinging(0.0, 5e-3, frequency_hz)], DT_S)
    assert found.lf_speed_mps == pytest.approx(5e-3 / np.sqrt(2.0), rel=0.02)


def held(plan: Plan, hand: Hand, more_delay: int) -> Outcome:
    """The eleven holds."""
    found = rendered(plan, built(plan))
    hold = next(case for case in cases(plan, found.force, hand) if case.name == "hold")
    return case_outcome(found, hold, hand, more_delay)


def test_a_heavy_device_that_swings_up_slowly_is_seen() -> None:
    chosen = dataclasses.replace(scene(mode="off"), device=HEAVY)
    plan = make_plan(golden_forces.model("hammerstein"), chosen, accept_unsafe=True)
    assert scene_loop(plan, DESIGN_HAND).spectral_radius(plan.stiffness_npm)[0] < 1.0
    assert scene_loop(plan, LIGHT).spectral_radius(plan.stiffness_npm)[0] > 1.0
    outcome = held(plan, LIGHT, 1)
    assert judge(outcome).grade == Grade.BAD
    assert outcome.vibration.grows
    speeds = [outcome.trace.velocity_mps[part] for part in outcome.played.still]
    first = next(speed for speed in speeds if vibration_of([speed], plan.dt_s).grows)
    power = np.abs(np.fft.rfft(first * np.hanning(len(first))))
    assert np.fft.rfftfreq(len(first), plan.dt_s)[power.argmax()] == pytest.approx(3.0, abs=0.7)
    quiet = held(plan, DESIGN_HAND, 0)
    assert judge(quiet).grade == Grade.GOOD
    assert not quiet.vibration.grows


def test_each_hold_begins_with_a_nudge() -> None:
    plan = make_plan(golden_forces.model("hammerstein"), scene(mode="off"))
    space = Workspace.of(plan)

    def force(position_m: np.ndarray) -> np.ndarray:
        return 500.0 * position_m

    found = held_case(space, force, LIGHT)
    motion, seconds = holding(space, HOLDS, 12.0)
    plain = pressing(space, motion, force, LIGHT, seconds)
    push_n = LIGHT.stiffness_npm * (found.scenario.intended_m - plain.intended_m)
    begins = np.flatnonzero(np.diff(push_n) > 0.4 * NUDGE_N)
    assert len(begins) == len(HOLDS)
    assert push_n.sum() * plan.dt_s == pytest.approx(len(HOLDS) * NUDGE_N * NUDGE_S, rel=0.06)
    assert all(push_n[part].max() < 1e-9 for part in found.still)


@pytest.mark.slow
def test_a_loop_that_is_not_bounded_is_refused_by_name() -> None:
    chosen = dataclasses.replace(scene(mode="off"), device=HEAVY)
    found = stability(make_plan(golden_forces.model("hammerstein"), chosen, accept_unsafe=True))
    assert found.check.stable
    assert re.search(r"Vibrates more and more on: .*hold \(light", found.recommendation)
    with pytest.raises(UnsafeError, match=r"the closed loop is not bounded on .*hold \(light"):
        found.require_bounded()


@pytest.mark.slow
def test_past_positions_vibrate_between_the_depths_that_were_looked_at_before() -> None:
    """A forest on past positions at 85 to 95 % of the depth, in the hand of a light holder."""
    training = paper_presses("dragon-skin-10")
    model: Model = fit_model(
        "rf-fd", "x", training, FitOptions(trees=20, past_positions=True, smooth_s=0.025)
    ).model
    plan = make_plan(model, Scene(schema=1, name="x", model="x"))
    outcome = held(plan, LIGHT, 1)
    assert Fault.LOUD in judge(outcome).faults
    speeds = [
        band_rms(outcome.trace.velocity_mps[part], plan.dt_s, 0.5) for part in outcome.played.still
    ]
    near = [speed for share, speed in zip(HOLDS, speeds, strict=True) if 0.85 < share < 0.95]
    assert near and max(near) > 2e-3
