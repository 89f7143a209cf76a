"""A model's own prediction on recordings: no guard, contact, coupling or limits."""

from collections.abc import Sequence
from functools import singledispatch

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.forest import forest_force, quantised_leaves, rounded
from springpot.codegen.model.model import Model
from springpot.codegen.model.regressors import Forest, Rbf, Regressor
from springpot.trainer.features.values import feature_values
from springpot.trainer.models.contact import depth_m
from springpot.trainer.models.motion import motions
from springpot.trainer.models.passive.passive_force import model_along
from springpot.trainer.models.rbf import rbf_force
from springpot.trainer.recordings.recording import Recording


def predict_n(model: Model, recording: Recording, rows: Indices | None = None) -> Samples:
    """Force along a recording's positions, (n,), N; or at `rows` of them, (rows,)."""
    rows = np.arange(len(recording.position_m)) if rows is None else rows
    return predict_each_n(model, [(recording, rows)])


def predict_each_n(model: Model, pieces: Sequence[tuple[Recording, Indices]]) -> Samples:
    """Force at rows of several recordings, (rows,), N: those of one session one after another.

    A forest's table is made once for all; its features know each recording alone.
    """
    recordings = [recording for recording, _ in pieces]
    depths = [depth_m(recording, model.contact) for recording in recordings]
    force_n = np.zeros(sum(len(rows) for _, rows in pieces))
    if model.features is not None and model.regressor is not None:
        values = [
            feature_values(model.features, depth, model.dt_s, rows)
            for depth, (_, rows) in zip(depths, pieces, strict=True)
        ]
        force_n += regressor_force(model.regressor, np.concatenate(values))
    if model.hammerstein is not None and model.hammerstein_adds:
        surface = model.contact == "surface"
        parts = [np.zeros(0)] * len(pieces)
        for motion in motions(recordings, depths, surface):
            here = model.hammerstein.at(recordings[motion.recordings[0]].place_m)
            along_n = model_along(here, motion, model.dt_s, surface)[0]
            for number, start in zip(motion.recordings, motion.starts, strict=True):
                parts[number] = along_n[start + pieces[number][1]]
        force_n += np.concatenate(parts)
    return force_n


@singledispatch
def regressor_force(regressor: Regressor, values: Samples) -> Samples:
    """Force of features (n, features), N, shape (n,). Each kind of regressor registers its own."""
    raise TypeError(f"{type(regressor).__name__} has no force: register it with regressor_force")


@regressor_force.register
def _forest_force(forest: Forest, values: Samples) -> Samples:
    features = values.astype(np.float32)
    if forest.quantisation is not None:
        features = rounded(forest.quantisation, features)
    force_n: Samples = forest_force(forest, quantised_leaves(forest), features, np.float64)
    return force_n


regressor_force.register(Rbf, rbf_force)
