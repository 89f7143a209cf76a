"""Answers of a study of similarity, by person and condition, and whom the rules leave out."""

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from springpot.basics import Samples
from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.responses import Response

_Key = TypeVar("_Key", bound=Hashable)


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


def by_condition(study: Study, responses: Sequence[Response]) -> dict[int, dict[str, float]]:
    """Return the mean answer by pair and person."""
    found: dict[int, dict[str, float]] = {pair: {} for pair in range(len(study.pair))}
    for (pair, person), answers in _answers(responses, lambda r: (r.pair, r.participant)).items():
        found[pair][person] = float(np.mean(answers))
    return found


def by_session(study: Study, responses: Sequence[Response]) -> Samples:
    """Return mean answers (person and condition, sessions) of those given in all sessions.

    Of the conditions that are compared, where some are: an anchor that everybody rates alike would
    make sessions agree by itself."""
    compared = {k for k, pair in enumerate(study.pair) if pair.factors}
    rated = [r for r in responses if not compared or r.pair in compared]
    answers = _answers(rated, lambda r: (r.participant, r.pair, r.session))
    rows = [
        [answers.get((*key, session + 1)) for session in range(study.sessions)]
        for key in dict.fromkeys((r.participant, r.pair) for r in rated)
    ]
    whole = [[float(np.mean(one or ())) for one in row] for row in rows if all(row)]
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
    answers = _answers(own, lambda r: r.pair).values()
    spreads = [float(np.std(some, ddof=1)) for some in answers if len(some) > 1]
    return float(np.mean(spreads)) if spreads else None


def _side_difference(study: Study, own: Sequence[Response]) -> float | None:
    pairs = study.pair
    turned = [r for r in own if pairs[r.pair].left != pairs[r.pair].right
              and pairs[r.pair].sides == "balanced"]  # fmt: skip
    sides = _answers(turned, lambda r: r.swapped)
    return float(np.mean(sides[False]) - np.mean(sides[True])) if len(sides) == 2 else None


def _answers(
    responses: Iterable[Response], key: Callable[[Response], _Key]
) -> dict[_Key, list[float]]:
    """Return the numbers that were answered, by a key of the response."""
    found: dict[_Key, list[float]] = {}
    for response in responses:
        found.setdefault(key(response), []).append(float(response.answer))
    return found
