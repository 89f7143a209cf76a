"""Answers of a study of similarity, by person and condition, and whom the rules leave out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from springpot.basics import Samples
from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.responses import Response


@dataclass(frozen=True, eq=False)
class ScoreTable:
    """Mean answer of each person in each cell of the factors, over sessions and repeats.

    factors: names, one or two; levels: of each; scores: (people, levels of the first, ...). Of two
    factors the first is the one that is compared within every level of the second.
    """

    people: tuple[str, ...]
    factors: tuple[str, ...]
    levels: tuple[tuple[str, ...], ...]
    scores: Samples


@dataclass(frozen=True)
class Consistency:
    """How steadily a person answered, and the rules that this breaks: none, and they stay.

    repeat_sd: standard deviation of repeated answers, mean over conditions. side_difference: mean
    answer with the pair's first stimulus left, less that with it right.
    """

    participant: str
    repeat_sd: float | None
    side_difference: float | None
    broken: tuple[str, ...]


def condition_title(study: Study, pair: int) -> str:
    """Return what a condition is called on the page: its factors, or its stimuli."""
    one = study.pair[pair]
    return ", ".join(one.factors.values()) if one.factors else one.title


def score_table(study: Study, responses: Sequence[Response]) -> ScoreTable | None:
    """Return the table that an analysis of variance takes; None if no pair has factors.

    Cells that nobody was asked in are nan, as are those of a person who has not come so far."""
    of = [pair.factors for pair in study.pair if pair.factors]
    if not of:
        return None
    names = tuple(of[0])
    levels = tuple(tuple(dict.fromkeys(factors[name] for factors in of)) for name in names)
    people = tuple(dict.fromkeys(response.participant for response in responses))
    total = np.zeros((len(people), *map(len, levels)))
    count = np.zeros_like(total)
    for response in responses:
        factors = study.pair[response.pair].factors
        if factors:
            place = tuple(level.index(factors[n]) for n, level in zip(names, levels, strict=True))
            total[people.index(response.participant), *place] += float(response.answer)
            count[people.index(response.participant), *place] += 1.0
    return ScoreTable(people, names, levels, total / np.where(count > 0.0, count, np.nan))


def by_condition(study: Study, responses: Sequence[Response]) -> dict[int, Mapping[str, float]]:
    """Return the mean answer by pair and person."""
    found: dict[int, dict[str, list[float]]] = {pair: {} for pair in range(len(study.pair))}
    for response in responses:
        of_person = found[response.pair].setdefault(response.participant, [])
        of_person.append(float(response.answer))
    return {
        pair: {person: float(np.mean(answers)) for person, answers in people.items()}
        for pair, people in found.items()
    }


def by_session(study: Study, responses: Sequence[Response]) -> Samples:
    """Return mean answers (person and condition, sessions) of those given in all sessions.

    Of the conditions that are compared, where some are: an anchor that everybody rates alike would
    make sessions agree by itself."""
    found: dict[tuple[str, int], list[list[float]]] = {}
    compared = {k for k, pair in enumerate(study.pair) if pair.factors}
    for response in responses:
        if compared and response.pair not in compared:
            continue
        key = response.participant, response.pair
        rows = found.setdefault(key, [[] for _ in range(study.sessions)])
        rows[response.session - 1].append(float(response.answer))
    whole = [[float(np.mean(one)) for one in rows] for rows in found.values() if all(rows)]
    return np.array(whole).reshape(len(whole), study.sessions)


def consistency(study: Study, responses: Sequence[Response]) -> list[Consistency]:
    """Judge every person by the rules of [exclude]."""
    found = []
    for participant in dict.fromkeys(response.participant for response in responses):
        own = [response for response in responses if response.participant == participant]
        spread, side = _repeat_sd(own), _side_difference(study, own)
        rules = study.exclude
        broken = []
        if rules.repeat_sd_above is not None and (spread or 0.0) > rules.repeat_sd_above:
            broken.append("repeat_sd_above")
        limit = rules.side_difference_above
        if limit is not None and abs(side or 0.0) > limit:
            broken.append("side_difference_above")
        found.append(Consistency(participant, spread, side, tuple(broken)))
    return found


def _repeat_sd(own: Sequence[Response]) -> float | None:
    answers: dict[int, list[float]] = {}
    for response in own:
        answers.setdefault(response.pair, []).append(float(response.answer))
    spreads = [float(np.std(a, ddof=1)) for a in answers.values() if len(a) > 1]
    return float(np.mean(spreads)) if spreads else None


def _side_difference(study: Study, own: Sequence[Response]) -> float | None:
    sides: tuple[list[float], list[float]] = ([], [])
    for response in own:
        pair = study.pair[response.pair]
        if pair.left != pair.right and pair.sides == "balanced":
            sides[response.swapped].append(float(response.answer))
    return float(np.mean(sides[0]) - np.mean(sides[1])) if all(sides) else None
