"""What outcomes and stated figures mean: grades, the order of cases, the words for people."""

import itertools
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from support.paths import ROOT
from support.small import model_file

from springpot import Scene
from springpot.codegen.coupling.loop_device import ASSUMED_DEVICE
from springpot.codegen.model.model_file import read_model
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.scene import Coupling, Device, Guard
from springpot.host.commands.stability import stability_rows
from springpot.host.emission.emission import _activity
from springpot.host.simulation.hand_loop import Scenario, Trace
from springpot.host.simulation.scenarios import Case
from springpot.host.stability.check import Stability
from springpot.host.stability.closed_loop import Outcome
from springpot.host.stability.judgement import (
    FAITHFUL_PERCENT,
    QUIET_MPS,
    Grade,
    device_advice,
    judge,
    judged_cases,
)
from springpot.host.stability.losses import Losses
from springpot.host.stability.verdict import map_words, why_unbounded
from springpot.host.stability.vibration import Vibration

WHOLE = ("hold", "tap-4hz", "fast", "deep", "long-hold", "stiff")
LOSING = ("lost-1", "lost-10-fast", "rate-50", "rate-10-fast")


def outcome(case: str, hand: str = "mid", delay: int = 0, **changed: Any) -> Outcome:
    still, dt_s = np.zeros(10), np.full(10, 1e-3)
    played = Case(
        case, Scenario(dt_s, still, still, still, np.zeros(10, dtype=np.uint8)),
        quiet=case in ("hold", "long-hold", "stiff"), stiffer=case == "stiff",
        ends=case.startswith(("rate-50", "rate-10")), beyond=case.endswith("-fast"),
    )  # fmt: skip
    found: dict[str, Any] = {
        "played": played, "hand": hand, "delay_samples": delay, "bounded": True,
        "max_depth_m": 0.01, "max_force_n": 5.0, "hf_speed_mps": 2e-4, "fidelity_percent": 2.0,
        "energy_out_j": -0.01,
        "trace": Trace(*[still] * 6, np.zeros(10, dtype=np.int32), 0),
        "model_only_n": still, "late": delay > 0,
        "latched_s": 0.03 if played.ends else None, "ended": played.ends,
    }  # fmt: skip
    return Outcome(**found | changed)


FAULTLESS = Losses(
    growth_n=0.0, error_n=0.1, above_n=0.1, allowed_n=0.5, returned_j=-1e-4,
    clean_returned_j=-1e-4, stored_j=0.05, force_step_n=0.2, clean_force_step_n=0.2,
    model_force_step_n=0.2, zero_ticks=0, clean_zero_ticks=0,
)  # fmt: skip


def losing(case: str, error_n: float = 0.1, **changed: Any) -> Outcome:
    return outcome(case, losses=replace(FAULTLESS, error_n=error_n), **changed)


def checked(outcomes: list[Outcome], stable: bool = True) -> Stability:
    """A check with these outcomes: only what words are made of."""
    cells = SimpleNamespace(active=lambda outside: (0, 18 if outside else 30), as_dict=dict)
    choice = SimpleNamespace(why="off: asked for", felt_npm=2500.0)
    plan = SimpleNamespace(scene=SimpleNamespace(name="pad", device=Device()), coupling=choice,
                           dt_s=1e-3, loop_device=ASSUMED_DEVICE,
                           output=SimpleNamespace(max_n=12.0, min_n=0.0))  # fmt: skip
    check = SimpleNamespace(stable=stable, spectral_radius=0.99, model_map=cells, scene_map=cells,
                            plan=plan, as_dict=dict)  # fmt: skip
    return Stability(cast(Any, check), cast(Any, plan), tuple(outcomes))


def usual(*instead: Outcome) -> list[Outcome]:
    """All cases with three hands and two delays, those of `instead` in their places."""
    others = {(item.case, item.hand, item.delay_samples): item for item in instead}
    made = []
    for case, hand, delay in itertools.product(WHOLE + LOSING, ("mid", "firm", "light"), (0, 1)):
        make = losing if case in LOSING else outcome
        percent = {"stiff": 34.0, "lost-10-fast": 25.0}.get(case, 2.0)
        fresh = make(case, hand=hand, delay=delay, fidelity_percent=percent)
        made.append(others.get((case, hand, delay), fresh))
    return made


def test_a_person_reads_a_screen_the_gravest_first() -> None:
    bad = outcome("deep", "firm", 1, bounded=False)
    kick = losing("lost-1", 2.0, hand="light")
    rows = stability_rows(checked(usual(bad, kick)))
    assert len(rows) < 15
    names = list(rows)
    assert names[0] == "verdict"
    assert names[1:3] == ["bad: deep, firm, 1 late", "bad: lost-1, light, 0 late"]
    assert rows[names[1]].startswith("not bounded; ")
    assert "stays wrong" in rows[names[2]]
    assert rows["cases"].startswith("6 of 8 are good")
    assert "Not bounded: deep (firm, delay 1)." in rows["verdict"]


def test_the_grades_of_the_how_to_page_are_those_that_are_given() -> None:
    """Fidelity is graded where no sample is lost and nothing is made stiffer, from 10 % on."""
    page = (ROOT / "docs/explanation/stability.md").read_text("utf-8")
    assert f"fidelity error above {FAITHFUL_PERCENT:g} %" in page
    assert f"above {1e3 * QUIET_MPS:g} mm/s on a hold" in page
    words = [line.split("|")[1].strip() for line in page.splitlines() if line.startswith("| ")]
    assert {grade.word for grade in Grade} <= {*words}
    for case in WHOLE + LOSING:
        make = losing if case in LOSING else outcome
        found = judge(make(case, fidelity_percent=FAITHFUL_PERCENT + 0.1))
        graded = case not in ("stiff", *LOSING)
        assert (found.grade == Grade.LOOK) == graded
        assert (found.grade == Grade.GOOD) == (not graded and not found.ends)


def test_an_unstable_loop_is_not_called_quiet() -> None:
    words = checked(usual(), stable=False).recommendation
    assert "Unstable: do not hold" in words
    assert "bounded and quiet" not in words


@pytest.mark.parametrize(
    ("found", "grade", "words"),
    [
        (outcome("hold"), Grade.GOOD, "bounded, quiet"),
        (outcome("tap-4hz", hf_speed_mps=0.1), Grade.GOOD, "bounded"),
        (outcome("hold", hf_speed_mps=2e-3), Grade.LOOK, "vibrates with 2 mm/s on a hold"),
        (outcome("fast", fidelity_percent=12.0), Grade.LOOK, "felt otherwise than the model"),
        (outcome("stiff", fidelity_percent=34.0), Grade.GOOD, "felt softer than it is"),
        (outcome("deep", bounded=False), Grade.BAD, "not bounded"),
        (losing("lost-1"), Grade.GOOD, "no kick"),
        (losing("lost-1", 1.0), Grade.BAD, "stays wrong"),
        (losing("lost-1-fast", 1.0), Grade.LOOK, "stays wrong"),
        (losing("lost-1", latched_s=0.3), Grade.BAD, "ends, though enough samples come"),
        (losing("rate-10", 9.0, bounded=False), Grade.ENDS, "ends after 30 ms, as it should"),
        (losing("rate-10", ended=False), Grade.BAD, "goes on though too few samples come"),
        (outcome("hold", vibration=Vibration(2e-3, 1.0)), Grade.LOOK, "sways with 2 mm/s"),
        (outcome("hold", vibration=Vibration(5e-4, 2.5)), Grade.BAD, "more and more"),
        (outcome("hold", vibration=Vibration(5e-4, 1.5)), Grade.GOOD, "bounded, quiet"),
    ],
)
def test_grades(found: Outcome, grade: Grade, words: str) -> None:
    judged = judge(found)
    assert judged.grade == grade
    assert words in judged.words


def test_the_gravest_hand_speaks_for_a_case() -> None:
    cases = judged_cases(usual(outcome("hold", "light", 1, hf_speed_mps=5e-3)))
    assert (cases[0].outcome.case, cases[0].outcome.hand) == ("hold", "light")
    assert [item.outcome.case for item in cases[-2:]] == ["rate-50", "rate-10-fast"]
    assert len(cases) == len(WHOLE + LOSING)


TOOL = Coupling(mode="tool", stiffness_npm=2000.0, damping_nspm=4.0)


@pytest.mark.parametrize(
    ("stated", "coupling", "says"),
    [
        ({}, Coupling(), []),
        ({"max_force_n": 12.0}, Coupling(), []),
        ({"max_force_n": 8.0}, Coupling(), ["may reach 12 N and its device gives 8 N"]),
        ({"velocity_noise_mps": 0.006}, TOOL, []),
        ({"velocity_noise_mps": 0.006}, Coupling(), []),
        ({"velocity_noise_mps": 0.006, "velocity": "device"}, TOOL, ["puts 0.024 N of noise"]),
    ],
)
def test_what_stated_figures_mean(
    tmp_path: Path, stated: dict[str, Any], coupling: Coupling, says: list[str]
) -> None:
    scene = Scene(schema=1, name="pad", model="model.spm", coupling=coupling,
                  guard=Guard(max_force_n=12.0), device=Device(**stated))  # fmt: skip
    plan = make_plan(read_model(model_file(tmp_path)), scene)
    advice = list(device_advice(plan))
    assert len(advice) == len(says)
    for words, said in zip(advice, says, strict=True):
        assert said in words


def cells(active: int) -> Any:
    return SimpleNamespace(active=lambda outside: (0, 18) if outside else (active, 30))


@pytest.mark.parametrize(
    ("of_model", "of_scene", "changed", "says"),
    [
        (0, 0, {}, []),
        (3, 3, {}, ["The model is not passive in 3 of 30"]),
        (0, 7, {"smooth_alpha": 0.1}, ["not passive in 7 of 30 cells, for its smooth"]),
        (0, 7, {"couple": object()}, ["for its coupling"]),
        (0, 7, {"loop_device": ASSUMED_DEVICE.later(2)}, ["for its delay of 2 samples"]),
        (2, 9, {"couple": object()}, ["The model is not passive in 2", "The scene is not passive"]),
    ],
)
def test_active_cells_of_the_scene_stand_beside_the_models(
    of_model: int, of_scene: int, changed: dict[str, Any], says: list[str]
) -> None:
    bare = {"smooth_alpha": None, "couple": None, "loop_device": ASSUMED_DEVICE}
    words = list(map_words(cast(Any, SimpleNamespace(**bare | changed)), cells(of_model),
                           cells(of_scene)))  # fmt: skip
    assert len(words) == len(says)
    for found, said in zip(words, says, strict=True):
        assert said in found


@pytest.mark.parametrize(
    ("found", "named"),
    [
        (outcome("deep", "light", 1, bounded=False), "deep (light, delay 1)"),
        (outcome("hold", vibration=Vibration(5e-4, 2.5)), "hold (mid)"),
        (losing("lost-1", latched_s=0.3), "lost-1 (mid)"),
        (losing("rate-10-fast", ended=False), "rate-10-fast (mid)"),
        (losing("lost-10-fast", bounded=False), "lost-10-fast (mid)"),
        (outcome("stiff", bounded=False), "stiff (mid)"),
        (outcome("hold", hf_speed_mps=2e-3), ""),
        (losing("rate-10-fast", bounded=False), ""),
        (losing("lost-1", 1.0), ""),
    ],
)
def test_every_outcome_that_is_not_bounded_is_refused_by_name(found: Outcome, named: str) -> None:
    """The light hand one sample late, and four times the trained speed, are no exceptions."""
    why = why_unbounded(a_plan(), usual(found))
    assert (named in why) if named else why == ""


def a_plan(regressor: bool = False, mode: str = "auto", **device: float) -> Any:
    """What of a plan says what may be changed."""
    scene = Scene(
        1, "pad", "pad.spm", coupling=Coupling(mode=cast(Any, mode)), device=Device(**device)
    )
    return SimpleNamespace(
        scene=scene, model=SimpleNamespace(regressor=object() if regressor else None),
        max_force_n=12.0, dt_s=1e-3,
        loop_device=replace(ASSUMED_DEVICE, delay_samples=int(1e3 * (scene.device.delay_s or 0))),
    )  # fmt: skip


SCENES = list(itertools.product(
    (False, True), ("auto", "off", "proxy"), ({}, {"delay_s": 0.002}), (11.9, 12.0),
))  # fmt: skip


@pytest.mark.parametrize(("regressor", "mode", "device", "max_force_n"), SCENES)
def test_no_remedy_is_what_the_scene_has_or_may_not_have(
    regressor: bool, mode: str, device: dict, max_force_n: float
) -> None:
    """Each remedy is offered if it would change the scene, and only then."""
    changed: dict[str, Any] = {"bounded": False, "max_force_n": max_force_n}
    plan = a_plan(regressor, mode, **device)
    for found in (
        outcome("hold", **changed),
        outcome("hold", delay=1, **changed),
        losing("lost-10-fast", **changed),
    ):
        faster = not regressor and (found.late or found.losses is not None)
        why = why_unbounded(plan, usual(found)).split("scene; ")[1]
        assert ("coupling.mode = auto" in why) == (mode != "auto")
        assert ("runtime.rate_hz of 2000 or more" in why) == faster
        assert ("hammerstein" in why) == regressor
        assert ("less delay" in why) == ("delay_s" in device)
        assert ("guard.max_force_n" in why) == (max_force_n >= 12.0)
        assert ("one of these or several: " in why) == ("; " in why)


@pytest.mark.parametrize("inside", [0, 3])
@pytest.mark.parametrize("outside", [0, 1])
def test_only_cells_that_give_energy_are_counted_by_emit(inside: int, outside: int) -> None:
    counts = {False: (inside, 30), True: (outside, 18)}
    told = " ".join(_activity(SimpleNamespace(model_map=SimpleNamespace(active=counts.get))))
    assert " 0 of" not in told
    assert ("3 of 30 small-signal cells" in told) == (inside > 0)
    assert ("1 of 18 small-signal cells beyond the trained depth" in told) == (outside > 0)
