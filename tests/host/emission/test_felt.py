"""A coupling that leaves little of the object is said, with what leaves more."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.c import golden_forces
from support.small import scene

from springpot import Model, Recording, Scene
from springpot.codegen.coupling.linear_loop import CHECKED_HANDS
from springpot.codegen.errors import UsageError
from springpot.codegen.make_plan import MIN_FELT_FRACTION, make_plan
from springpot.codegen.scene import Coupling, Runtime
from springpot.host.emission.result import coupling_notices, rate_notices
from springpot.host.stability.linear import margin_sentence, plan_margin
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions


@cache
def fitted(kind: str, rate_hz: float, stiff: float = 1.0) -> Model:
    """A model of an object of 12 N/mm at most, pressed by 5 mm at some rate."""
    presses = []
    for hz in (0.25, 0.5, 1.0):
        position_m = 2.5e-3 * (1 - np.cos(2 * np.pi * hz * np.arange(0, 4 / hz, 1 / rate_hz)))
        force_n = stiff * 38.6 * (position_m / 5e-3) ** 1.6
        presses.append(Recording(f"{hz}", position_m, force_n, 1 / rate_hz))
    return fit_model(kind, "x", presses, FitOptions(trees=2, smooth_s=0.0, n_centers=9)).model


def with_rate(rate_hz: float | None, mode: str = "auto") -> Scene:
    return replace(scene(mode=mode), runtime=Runtime(number="float32", rate_hz=rate_hz))


@pytest.mark.few(1)
@pytest.mark.parametrize("stiff", [0.5, 1.0, 2.5])
def test_the_rate_that_is_named_gives_what_is_said(stiff: float) -> None:
    model = fitted("hammerstein", 200.0, stiff)
    *_, notice = coupling_notices(make_plan(model, with_rate(200.0)))
    named = re.search(r"rate_hz = (\d+) gives ([\d.]+) N/mm", notice)
    assert named is not None, notice
    plan = make_plan(model, with_rate(float(named[1])))
    assert f"{1e-3 * plan.coupling.felt_npm:.3g}" == named[2]
    if stiff < 2.5:  # stiffer, the encoder's noise keeps a proxy before the loop at any rate
        assert plan.coupling.felt_npm >= MIN_FELT_FRACTION * plan.stiffness_npm
        assert coupling_notices(plan) == []


@pytest.mark.few(1)
@pytest.mark.parametrize("stiff", [0.02, 0.2, 1.0, 2.5])
def test_a_slow_recording_is_rendered_at_1000_hz_where_it_must(stiff: float) -> None:
    model = fitted("hammerstein", 200.0, stiff)
    plan = make_plan(model, with_rate(None))
    held = not coupling_notices(make_plan(model, with_rate(200.0)))
    assert 1 / plan.dt_s == pytest.approx(200.0 if held else 1000.0)
    assert held == (rate_notices(plan) == []) == (stiff < 0.1)


@pytest.mark.slow
@pytest.mark.parametrize("rate_hz", [40.0, 60.0, 90.0, 200.0, 1000.0])
def test_a_loop_that_no_coupling_holds_for_every_hand_is_said(rate_hz: float) -> None:
    plan = make_plan(fitted("hammerstein", 200.0), with_rate(rate_hz), accept_unsafe=True)
    said = any("times as stiff as it is" in notice for notice in coupling_notices(plan))
    assert said == (not plan_margin(plan, CHECKED_HANDS).is_stable)
    assert not said or rate_hz < 250.0


@pytest.mark.slow
def test_a_stated_coupling_is_measured_too() -> None:
    soft = replace(with_rate(1000.0), coupling=Coupling("proxy", 500.0, 5.0, 0.05))
    *_, notice = coupling_notices(make_plan(fitted("hammerstein", 200.0), soft))
    assert "the scene states that coupling" in notice
    assert coupling_notices(make_plan(fitted("hammerstein", 200.0), with_rate(1000.0, "off"))) == []


def test_recordings_slower_than_any_loop_are_rendered() -> None:
    assert make_plan(fitted("hammerstein", 5.0), with_rate(1000.0)).dt_s == 1e-3
    assert make_plan(fitted("hammerstein", 5.0), with_rate(None)).dt_s == 1e-3
    with pytest.raises(UsageError, match="rate_hz = 1000, at which it is as exact"):
        make_plan(fitted("hammerstein", 5.0), with_rate(None, "off"))


@pytest.mark.parametrize(("kind", "as_spring"), [("rbf-fd", True), ("hammerstein", False)])
def test_a_verdict_on_a_regressor_says_that_its_losses_are_not_counted(
    kind: str, as_spring: bool
) -> None:
    plan = make_plan(golden_forces.model(kind), scene(mode="auto"))
    lines = [plan.coupling.why, margin_sentence(plan_margin(plan))]
    assert [("this object (taken as a spring" in line) for line in lines] == [as_spring] * 2
