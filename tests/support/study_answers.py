"""Answers of a study without devices: people whose ratings are known."""

from collections.abc import Mapping

import numpy as np

from springpot.host.wings.study.definition import (
    ComparedPair,
    EquivalenceRule,
    Exclude,
    MethodName,
    Question,
    Stimulus,
    Study,
)
from springpot.host.wings.study.responses import Reply, Response

METHODS, MATERIALS = ("RF", "RBF", "REAL"), ("soft", "hard")


def rating_study(margin: float | None = 10.0) -> Study:
    """Two materials by three methods, and a pair without factors that is asked four times."""
    stimuli = [Stimulus(f"{method} {material}", **_kind(method, material))
               for material in MATERIALS for method in METHODS]  # fmt: skip
    pairs = [
        ComparedPair(
            f"REAL {material}", f"{method} {material}",
            factors={"method": method, "material": material},
        )
        for material in MATERIALS for method in METHODS
    ]  # fmt: skip
    pairs.append(ComparedPair("REAL soft", "REAL hard", repeats=4))
    pairs.append(ComparedPair("RF soft", "RBF soft"))
    return Study(
        schema=1, name="known people", method="similarity", stimulus=stimuli, pair=pairs,
        sessions=3, exclude=Exclude(30.0, 30.0),
        equivalence=None if margin is None else EquivalenceRule(margin),
        question=[Question("Vibrations?", ["yes", "no"]), Question("What else?")],
    )  # fmt: skip


def _kind(method: str, material: str) -> Mapping[str, str]:
    return {"real": material} if method == "REAL" else {"scene": f"{method}-{material}.toml"}


def ratings(
    study: Study, people: int, seed: int = 1, sd: float = 5.0, differ: float = 30.0
) -> list[Response]:
    """RF of the soft object is rated lower by differ; the last person but one scatters widely, and
    the last one rates what is swapped 60 lower."""
    rng = np.random.default_rng(seed)
    found = []
    for person in range(people):
        level = rng.normal(75.0, 6.0)
        for session in range(1, study.sessions + 1):
            trials = [k for k, pair in enumerate(study.pair) for _ in range(pair.repeats)]
            for number, pair in enumerate(trials):
                one = study.pair[pair]
                swapped = bool((session + number) % 2)
                rating = level + rng.normal(0.0, sd)
                rating -= differ * (one.factors == {"method": "RF", "material": "soft"})
                if person == people - 2:
                    rating = (5.0, 95.0, 20.0)[session - 1]
                if person == people - 1:
                    rating = level - 60.0 * (swapped and one.left != one.right)
                shown = (one.right, one.left) if swapped else (one.left, one.right)
                found.append(response(f"{person + 1:02d}", session, number + 1, pair, shown,
                                      swapped, float(np.clip(rating, 0.0, 100.0))))  # fmt: skip
    return found


def response(
    participant: str,
    session: int,
    number: int,
    pair: int,
    shown: tuple[str, ...],
    swapped: bool,
    answer: float | str,
    correct: bool | None = None,
) -> Response:
    return Response(
        participant, session, number, 1, pair, shown, swapped, answer, correct, 4.0, 3, 0.005,
        0.05, 0, None,
    )  # fmt: skip


def choice_study(method: MethodName, levels: tuple[float, ...], repeats: int) -> Study:
    """A standard of 1 against scenes of other levels."""
    stimuli = [Stimulus("standard", scene="a.toml")]
    stimuli += [Stimulus(f"x{level:g}", scene="a.toml", stiffer=level) for level in levels]
    pairs = [ComparedPair("standard", f"x{level:g}", repeats, series="stiffness")
             for level in levels]  # fmt: skip
    return Study(schema=1, name="levels", method=method, stimulus=stimuli, pair=pairs)


def replies(study: Study, people: int) -> list[Reply]:
    """Two thirds say yes; free text is each one's own."""
    return [
        Reply(f"{person + 1:02d}", question, answer)
        for person in range(people)
        for question, answer in enumerate(("no" if person % 3 == 0 else "yes", f"remark {person}"))
    ]
