"""Similarity: variance, pairs of conditions, whether they are alike, and what could be found."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np

from springpot import DataError
from springpot.basics import Samples
from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.report.scores import ScoreTable, by_session, score_table
from springpot.host.wings.study.responses import Response
from springpot.host.wings.study.statistics.agreement import intraclass
from springpot.host.wings.study.statistics.anova import repeated_measures
from springpot.host.wings.study.statistics.equivalence import equivalence
from springpot.host.wings.study.statistics.pairs import letters, pair_differences
from springpot.host.wings.study.statistics.power import (
    detectable,
    difference_power,
    equivalence_power,
    people_needed,
)

ALPHA, TARGET_POWER = 0.05, 0.8
Row = dict[str, Any]
Scored = tuple[str, Samples]  # a condition, and a score a person


@dataclass
class Comparisons:
    """Rows of what was compared, of a group of people; notes: why something is not there.

    within: the level of the second factor that a row is within; "" where there is one factor.
    letters: within -> level of the first factor -> letters.
    """

    people: tuple[str, ...] = ()
    table: ScoreTable | None = None
    anova: list[Row] = field(default_factory=list)
    simple: list[Row] = field(default_factory=list)
    pairs: list[Row] = field(default_factory=list)
    letters: dict[str, dict[str, str]] = field(default_factory=dict)
    equivalence: list[Row] = field(default_factory=list)
    power: Row | None = None
    agreement: list[Row] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def compare(study: Study, responses: Sequence[Response]) -> Comparisons:
    """Compare all conditions; what the answers do not suffice for yet is a note without rows."""
    people = tuple(dict.fromkeys(response.participant for response in responses))
    found = Comparisons(people, score_table(study, responses))
    if study.sessions > 1:
        _noted(found, _agreement, study, responses)
    if found.table is None:
        found.notes.append("no pair has factors: conditions are described, and not compared")
        return found
    _complete(found)
    _noted(found, _variance)
    for within, scores, levels in _slices(found.table):
        _noted(found, _pairs, within, scores, levels)
        if study.equivalence is not None:
            for one, other in combinations(range(len(levels)), 2):
                first, second = ((levels[k], scores[:, k]) for k in (one, other))
                _noted(found, _alike, within, first, second, study.equivalence.margin)
    if found.pairs:
        found.power = _power(study, found)
    return found


def _noted(found: Comparisons, part: Any, *arguments: Any) -> None:
    try:
        part(found, *arguments)
    except DataError as error:
        if str(error) not in found.notes:
            found.notes.append(str(error))


def _complete(found: Comparisons) -> None:
    """Leave out people without an answer in every cell, and say so."""
    table = found.table
    assert table is not None
    whole = [bool(np.all(np.isfinite(scores))) for scores in table.scores]
    if not all(whole):
        left = [person for person, use in zip(table.people, whole, strict=True) if not use]
        found.notes.append(
            f"not yet asked in every condition, and not in the comparisons: {', '.join(left)}"
        )
        kept = tuple(person for person, use in zip(table.people, whole, strict=True) if use)
        found.table = ScoreTable(kept, table.factors, table.levels, table.scores[whole])


def _slices(table: ScoreTable) -> list[tuple[str, Any, tuple[str, ...]]]:
    """Return level of the second factor, scores (people, levels of the first), names of those."""
    if len(table.factors) == 1:
        return [("", table.scores, table.levels[0])]
    return [
        (within, table.scores[:, :, k], table.levels[0]) for k, within in enumerate(table.levels[1])
    ]


def _variance(found: Comparisons) -> None:
    assert found.table is not None
    table = found.table
    found.anova = [asdict(effect) for effect in repeated_measures(table.scores, table.factors)]
    if len(table.factors) == 2:
        for within, scores, _ in _slices(table):
            (effect,) = repeated_measures(scores, table.factors[:1])
            found.simple.append({"within": within, **asdict(effect)})


def _pairs(found: Comparisons, within: str, scores: Any, levels: tuple[str, ...]) -> None:
    pairs = pair_differences(scores, levels)
    found.pairs += [{"within": within, **asdict(pair)} for pair in pairs]
    ranked = sorted(levels, key=lambda level: -float(scores[:, levels.index(level)].mean()))
    different = [(pair.first, pair.second) for pair in pairs if pair.p_tukey < ALPHA]
    found.letters[within] = letters(ranked, different)


def _alike(found: Comparisons, within: str, first: Scored, second: Scored, margin: float) -> None:
    row = asdict(equivalence(first, second, margin, ALPHA))
    found.equivalence.append({"within": within, **row})


def _agreement(found: Comparisons, study: Study, responses: Sequence[Response]) -> None:
    sessions = by_session(study, responses)
    found.agreement = [asdict(one) for one in intraclass(sessions)]


def _power(study: Study, found: Comparisons) -> Row:
    """Return the power of comparing two conditions with the root mean square scatter found here."""
    assert found.table is not None
    people = len(found.table.people)
    variances = [
        np.var(scores[:, i] - scores[:, j], ddof=1)
        for _, scores, levels in _slices(found.table)
        for i, j in combinations(range(len(levels)), 2)
    ]
    sd = float(np.sqrt(np.mean(variances)))
    smallest = detectable(people, TARGET_POWER, ALPHA)
    power: Row = {
        "people": people,
        "sd": sd,
        "target": TARGET_POWER,
        "detectable_d_z": smallest,
        "detectable": smallest * sd,
        **dict.fromkeys(("margin", "difference", "equivalence", "people_for_difference",
                         "people_for_equivalence")),
    }  # fmt: skip
    if study.equivalence is not None and sd > 0.0:
        margin = study.equivalence.margin
        differs = partial(difference_power, d_z=margin / sd)
        alike = partial(equivalence_power, margin_z=margin / sd)
        power |= {
            "margin": margin,
            "difference": differs(people),
            "equivalence": alike(people),
            "people_for_difference": people_needed(differs, TARGET_POWER),
            "people_for_equivalence": people_needed(alike, TARGET_POWER),
        }
    return power
