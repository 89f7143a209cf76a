"""Orders and sides: a function of the study's structure, the participant and the session alone.

Resuming therefore needs no state, and other names for the stimuli give the same order.
"""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from springpot.host.wings.study.definition import Study


@dataclass(frozen=True)
class PlannedTrial:
    """One trial, before its level is known where that depends on answers.

    number: in its session, from 1. pair: index into `Study.pair`; None of an adaptive method.
    series: of an adaptive method. swapped: the pair's right stimulus comes first. second: abx: X is
    what slot B holds; same-different: both slots hold the same.
    """

    number: int
    pair: int | None
    series: str
    swapped: bool
    second: bool


def fixed_trials(study: Study, participant: int, session: int) -> list[PlannedTrial]:
    """Return trials of a session in order; participant from 1, session from 1 (0: practice)."""
    order = _order(study, participant, session)
    counts = [_before(study, pair, session) for pair in range(len(study.pair))]
    trials = []
    for number, pair in enumerate(order, 1):
        swapped, second = _sides(study, participant, f"{pair}", counts[pair], session)
        counts[pair] += 1
        swapped = swapped and study.pair[pair].sides == "balanced"
        trials.append(PlannedTrial(number, pair, study.pair[pair].series, swapped, second))
    return trials


def adaptive_trial(
    study: Study, participant: int, session: int, open_series: Sequence[str], done: Sequence[str]
) -> PlannedTrial:
    """Return the next trial of an adaptive method: the series and sides of it.

    open_series: not ended yet. done: series of each trial of this session so far.
    """
    number = len(done) + 1
    random = _random(study, participant, session, "series", number)
    series = open_series[int(random.integers(len(open_series)))]
    occurrence = sum(name == series for name in done)
    swapped, second = _sides(study, participant, f"series {series}", occurrence, session)
    return PlannedTrial(number, None, series, swapped, second)


def williams_rows(conditions: int) -> list[list[int]]:
    """Return orders in which each condition follows each other one equally often (Williams 1949).

    As many rows as conditions, twice as many where that is odd.
    """
    first = [0]
    for k in range(1, conditions):
        first.append((k + 1) // 2 if k % 2 else conditions - k // 2)
    rows = [[(value + shift) % conditions for value in first] for shift in range(conditions)]
    return rows + [row[::-1] for row in rows] if conditions % 2 else rows


def _order(study: Study, participant: int, session: int) -> list[int]:
    random = _random(study, participant, session, "order")
    pairs = [k for k, pair in enumerate(study.pair) for _ in range(pair.repeats)]
    if session == 0:
        return [pairs[int(k)] for k in random.integers(len(pairs), size=study.practice)]
    if study.order == "random":
        return [int(k) for k in random.permutation(pairs)]
    rows = williams_rows(len(study.pair))
    labels = _random(study, 0, 0, "labels").permutation(len(study.pair))
    row = rows[((participant - 1) * study.sessions + session - 1) % len(rows)]
    return [int(labels[k]) for k in row]


def _before(study: Study, pair: int, session: int) -> int:
    """Return how often a pair was shown in the sessions before."""
    return max(0, session - 1) * study.pair[pair].repeats


def _sides(
    study: Study, participant: int, what: str, occurrence: int, session: int
) -> tuple[bool, bool]:
    """Return both choices of a trial: of four occurrences each combination comes once.

    The second of two is the opposite of the first in both, so that no count is ever more than one
    ahead; every other participant has them the other way round, so that nor is a group's.
    """
    block, place = divmod(occurrence, 4)
    random = _random(study, 0, int(session == 0), "sides", what, block)
    first, other = int(random.integers(4)), int(random.integers(2))
    third = first ^ (1 if other else 2)
    bits = (first, first ^ 3, third, third ^ 3)[place] ^ (3 if participant % 2 else 0)
    return bool(bits & 1), bool(bits & 2)


def _random(study: Study, *words: object) -> np.random.Generator:
    """Return random numbers that depend on the study's structure and on these words alone."""
    text = json.dumps([_structure(study), *words], separators=(",", ":"))
    return np.random.default_rng(list(hashlib.sha256(text.encode()).digest()))


def _structure(study: Study) -> list[object]:
    """Return what is compared with what, without a name."""
    names = [stimulus.name for stimulus in study.stimulus]
    series = list(dict.fromkeys(pair.series for pair in study.pair))
    pairs = [
        [names.index(pair.left), names.index(pair.right), pair.repeats, series.index(pair.series)]
        for pair in study.pair
    ]
    return [study.name, study.method, study.sessions, study.order, study.practice, pairs]
