"""Choose how the training recordings begin: at rest, or each where the one before ended.

Foams and food that are pressed again start 8 to 15 % softer than at rest; a fresh specimen for each
recording does not. Neither is right for all, so held-out errors decide.
"""

from dataclasses import replace
from math import inf

import numpy as np

from springpot.codegen.arrays import Indices, Samples, rms
from springpot.codegen.model.passive import Hammerstein
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive.passive_fit import (
    NODES,
    PENALTIES,
    PassiveChoice,
    build_laws,
    required_error_n,
    select_richer,
)
from springpot.trainer.models.passive.passive_force import simulate_passive, store_memory
from springpot.trainer.models.passive.passive_terms import DEPTH_POLES, build_model
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import group_by_site

_HOPELESS_RATIO = 3.0  # times the error that is needed; damage and flow took 2.2 times off at most
# Times the error from rest, where each press begins with the stored state: 1.7 where three presses
# of an object that relaxes for minutes go on, 3.5 to 8.5 where the last has its position in cm.
_MAX_START_RATIO = 2.5


def select_start(data: TrainingSet, options: FitOptions) -> TrainingSet:
    """Choose if recordings begin at rest or go on from each other, by held-out error.

    Going on has to take a tenth off. A model begins every press with what the last one left: if
    that misses the presses, the last one is unlike the others, and they begin at rest. Decided once
    for the options that it depends on. Recordings with times of their own in a session are left as
    they are, and those of several places.
    """
    timed = any(recording.session for recording in data.recordings)
    if (
        data.continues
        or timed
        or len(data.recordings) < 2
        or len(group_by_site(data.recordings)) > 1
    ):
        return data
    continued = replace(data, continues=True)

    def decide() -> TrainingSet:
        rested = _select_quickly(data, options)
        carried_on = _select_quickly(continued, options, required_error_n(rested))
        if select_richer(rested, carried_on) is not carried_on:
            return data
        stored_n, rested_n = (
            _press_error_n(build_model(choice.terms, choice.full_weights), begun, data)
            for choice, begun in ((carried_on, continued), (rested, data))
        )
        return continued if stored_n <= _MAX_START_RATIO * rested_n else data

    return data.cached(("start", options.fraction, options.seed, options.poles), decide)[0]


def _press_error_n(model: Hammerstein, begun: TrainingSet, data: TrainingSet) -> float:
    """RMSE of each press of `data` by itself, from the state that the model stores, N."""
    model = store_memory(model, begun)
    surface, all_rows = data.contact == "surface", np.arange(data.rows_total)

    def simulate(motion: DepthMotion, rows: Indices) -> Samples:
        return simulate_passive(model, motion, data.dt_s, surface)[0][rows]

    return rms(data.map_motions(all_rows, simulate) - data.force_n(all_rows))


def _select_quickly(data: TrainingSet, options: FitOptions, most_n: float = inf) -> PassiveChoice:
    """Return the better of a plain law and one with damage and flow, of one penalty.

    That is the plain one if it errs by so much more than most_n that nothing repairs it.
    """
    laws = build_laws(data, options, NODES[0])
    plain, *_ = laws.fit_law((), PENALTIES[1:2], most_n)
    if options.poles < DEPTH_POLES or plain.error_n > _HOPELESS_RATIO * most_n:
        return plain
    richer, *_ = laws.fit_law(("damage", "flow"), PENALTIES[1:2], most_n)
    return min(plain, richer, key=lambda choice: choice.error_n)
