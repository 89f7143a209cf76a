"""What outcomes and stated figures mean: grades, the order of cases, the words for people."""

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from springpot.host.simulation.hand_loop import Scenario, Trace
from springpot.host.simulation.scenarios import Case
from springpot.host.stability.closed_loop import Outcome, Vibration
from springpot.host.stability.losses import SampleLossEffects
from springpot.host.stability.verdict import Grade, grade_outcome, refusal_reason, worst_by_case

WHOLE = ("hold", "tap-4hz", "fast", "deep", "long-hold", "stiff")
LOSING = ("lost-1", "lost-10-fast", "rate-50", "rate-10-fast")


def outcome(name: str, hand: str = "mid", delay: int = 0, **changed: Any) -> Outcome:
    still, dt_s = np.zeros(10), np.full(10, 1e-3)
    case = Case(
        name, Scenario(dt_s, still, still, still, np.zeros(10, dtype=np.uint8)),
        must_be_quiet=name in ("hold", "long-hold", "stiff"), on_stiffer_object=name == "stiff",
        must_latch=name.startswith(("rate-50", "rate-10")),
        faster_than_trained=name.endswith("-fast"),
    )  # fmt: skip
    found: dict[str, Any] = {
        "case": case, "hand": hand, "delay_samples": delay, "bounded": True,
        "max_depth_m": 0.01, "max_force_n": 5.0, "hf_speed_mps": 2e-4, "fidelity_percent": 2.0,
        "energy_out_j": -0.01,
        "trace": Trace(*[still] * 6, np.zeros(10, dtype=np.int32), 0),
        "model_only_n": still, "late": delay > 0,
        "latched_s": 0.03 if case.must_latch else None, "ended": case.must_latch,
    }  # fmt: skip
    return Outcome(**found | changed)


FAULTLESS = SampleLossEffects(
    growth_n=0.0, error_n=0.1, above_n=0.1, allowed_n=0.5, returned_j=-1e-4,
    clean_returned_j=-1e-4, stored_j=0.05,
)  # fmt: skip


def losing(case: str, error_n: float = 0.1, **changed: Any) -> Outcome:
    return outcome(case, losses=replace(FAULTLESS, error_n=error_n), **changed)


def usual(*instead: Outcome) -> list[Outcome]:
    """All cases with three hands and two delays, those of `instead` in their places."""
    others = {(item.case_name, item.hand, item.delay_samples): item for item in instead}
    made = []
    for case, hand, delay in itertools.product(WHOLE + LOSING, ("mid", "firm", "light"), (0, 1)):
        make = losing if case in LOSING else outcome
        percent = {"stiff": 34.0, "lost-10-fast": 25.0}.get(case, 2.0)
        fresh = make(case, hand=hand, delay=delay, fidelity_percent=percent)
        made.append(others.get((case, hand, delay), fresh))
    return made


@pytest.mark.parametrize(
    ("found", "grade", "words"),
    [
        (outcome("hold"), Grade.GOOD, "bounded, quiet"),
        (outcome("hold", hf_speed_mps=1.9e-2), Grade.LOOK, "vibrates with 19 mm/s on a hold"),
        (outcome("hold", hf_speed_mps=2.1e-2), Grade.BAD, "vibrates with 21 mm/s on a hold"),
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
        (outcome("hold", vibration=Vibration(2e-3, 1.0)), Grade.LOOK, "vibrates with 2 mm/s"),
        (outcome("hold", vibration=Vibration(5e-4, 2.5)), Grade.BAD, "more and more"),
        (outcome("hold", vibration=Vibration(5e-4, 1.5)), Grade.GOOD, "bounded, quiet"),
    ],
)
def test_grades(found: Outcome, grade: Grade, words: str) -> None:
    judged = grade_outcome(found)
    assert judged.grade == grade and words in judged.words


def test_the_gravest_hand_speaks_for_a_case() -> None:
    cases = worst_by_case(usual(outcome("hold", "light", 1, hf_speed_mps=5e-3)))
    assert (cases[0].outcome.case_name, cases[0].outcome.hand) == ("hold", "light")
    assert [item.outcome.case_name for item in cases[-2:]] == ["rate-50", "rate-10-fast"]
    assert len(cases) == len(WHOLE + LOSING)


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
    why = refusal_reason("pad", usual(found))
    assert (named in why) if named else why == ""
