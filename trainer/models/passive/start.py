"""How the training recordings begin: each with an object at rest, or where the one before ended.

Foams and food that are pressed again start 8 to 15 % softer than at rest; a fresh specimen for each
recording does not. Neither is right for all, so held-out errors decide.
"""

from dataclasses import replace
from math import inf

from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive.passive_fit import (
    NODES,
    PENALTIES,
    PassiveChoice,
    better,
    laws_of,
    needed_n,
)
from springpot.trainer.models.passive.passive_terms import DEPTH_POLES
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import sites_of

_HOPELESS = 3.0  # times the error that is needed; damage and flow took 2.2 times off at most


def with_start(data: TrainingSet, options: FitOptions) -> TrainingSet:
    """Return the set; if held-out errors are a tenth lower so, as recordings that go on.

    Decided once for the options that it depends on. Recordings with times of their own in a session
    are left as they are, and those of several places.
    """
    timed = any(recording.session for recording in data.recordings)
    if data.continues or timed or len(data.recordings) < 2 or len(sites_of(data.recordings)) > 1:
        return data
    going_on = replace(data, continues=True)

    def found() -> TrainingSet:
        rested = _quick_choice(data, options)
        other = _quick_choice(going_on, options, needed_n(rested))
        return going_on if better(rested, other) is other else data

    return data.once(("start", options.fraction, options.seed, options.poles), found)[0]


def _quick_choice(data: TrainingSet, options: FitOptions, most_n: float = inf) -> PassiveChoice:
    """The better of a plain law and one with damage and flow, of one penalty.

    The plain one if it errs by so much more than most_n that nothing repairs it.
    """
    laws = laws_of(data, options, NODES[0])
    plain, *_ = laws.choices((), PENALTIES[1:2], most_n)
    if options.poles < DEPTH_POLES or plain.error_n > _HOPELESS * most_n:
        return plain
    richer, *_ = laws.choices(("damage", "flow"), PENALTIES[1:2], most_n)
    return min(plain, richer, key=lambda choice: choice.error_n)
