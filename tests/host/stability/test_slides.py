"""A hand of three axes on a map: quiet, bounded, and what is planted is found."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.small import passive_model, scene

from springpot import Coupling, ScenePlaces
from springpot.checks import QUIET_MPS, stability
from springpot.codegen.coupling.auto import spring_limit_npm
from springpot.codegen.model.model_file import read_model
from springpot.emission import Plan, make_plan
from springpot.host.simulation.slide_cases import slide_cases
from springpot.host.stability.slides import SlideOutcome, run_slides
from springpot.host.stability.verdict import slide_words, why_unbounded
from springpot.native import built

LUMP = Path(__file__).parents[2] / "golden" / "press" / "lump.spm"


def sliding(friction: float) -> Plan:
    chosen = replace(scene(), places=ScenePlaces("lateral", 8.0, friction))
    return make_plan(read_model(LUMP), replace(chosen, coupling=Coupling(mode="off")))


def found(plan: Plan) -> list[SlideOutcome]:
    with built(plan) as library:
        return list(run_slides(plan, library))


@pytest.mark.parametrize("friction", [0.0, 0.3, pytest.param(0.8, marks=pytest.mark.slow)])
def test_slides_holds_and_rounds_are_bounded_and_quiet_with_every_hand(friction: float) -> None:
    outcomes = found(sliding(friction))
    assert len(outcomes) == 24
    assert not [item for item in outcomes if item.unbounded or item.loud(QUIET_MPS)]
    assert list(slide_words(outcomes)) == [
        "Slides, holds on a flank and rounds are bounded and quiet with all hands."
    ]
    assert why_unbounded(sliding(friction), (), outcomes) == ""


def test_a_spring_that_the_device_does_not_bear_is_found() -> None:
    plan = sliding(0.8)
    stiff_npm = np.float32(1.2 * spring_limit_npm(plan.dt_s, plan.loop_device))
    anchor = replace(plan.lateral.anchor, stick_npm=stiff_npm)
    outcomes = found(replace(plan, lateral=replace(plan.lateral, anchor=anchor)))
    loud = [item for item in outcomes if item.loud(QUIET_MPS)]
    assert {(item.case, item.hand, item.late) for item in loud} == {("edge", "light", True)}
    assert any("edge (light, delay 1)" in words for words in slide_words(outcomes))


def test_a_round_that_gives_energy_is_named() -> None:
    gives = replace(found(sliding(0.0))[2], returned_j=0.002, stored_j=0.02)
    assert gives.case == "orbit"
    assert list(slide_words([gives])) == ["Gives energy on: orbit (mid)."]
    words = why_unbounded(sliding(0.0), (), [gives])
    assert "orbit (mid)" in words
    assert "rate_hz of 2000" in words
    assert "coupling" not in words


def test_the_cases_are_about_the_steepest_edge_of_the_map() -> None:
    plan = sliding(0.0)
    amounts = plan.lateral.placed.amounts[:, :, 0]
    steepest = max(
        np.abs(amounts[2:] - amounts[:-2]).max(), np.abs(amounts[:, 2:] - amounts[:, :-2]).max()
    )
    slide = slide_cases(plan)[0]
    low_m, high_m = slide.path_m[:, :2].min(axis=0), slide.path_m[:, :2].max(axis=0)
    step_m = 0.03 / (np.array(amounts.shape) - 1)
    steps = (high_m - low_m) / step_m
    assert sorted(np.round(steps, 4).tolist()) == [0.0, 4.0]
    nodes = np.stack([low_m, high_m]) / step_m + np.sign(steps.round()) * [[1.0], [-1.0]]
    ends = [amounts[tuple(node)] for node in np.round(nodes).astype(int)]
    assert abs(ends[1] - ends[0]) == pytest.approx(steepest)


@pytest.mark.slow
def test_the_whole_check_of_a_scene_that_slides_has_them_and_of_another_has_none() -> None:
    whole = stability(sliding(0.3))
    assert len(whole.as_dict()["slides"]) == 24
    assert "with all hands." in whole.recommendation
    assert stability(make_plan(passive_model(), scene())).as_dict()["slides"] == []
