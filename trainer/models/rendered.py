"""Features as the C computes them for a regressor that was fitted elsewhere, and why it errs."""

from typing import Any

import numpy as np

from springpot.codegen.arrays import Indices, Reals
from springpot.codegen.model.features import Features
from springpot.codegen.model.forest import quantise_leaves
from springpot.codegen.model.regressors import Expression, Forest, Linear, Regressor
from springpot.codegen.stages import model_stages  # noqa: F401 (registers the stages)
from springpot.codegen.stages.stage import feature_stage
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.signals import estimate_history_m

# Of depths in m: scikit-learn takes values closer than 1e-7 for equal, 0.8 nm. The same for every
# set: one that followed the depth gave a shallower test other features than its training.
FEATURE_SCALE = 128.0


def features_of_c(data: TrainingSet, features: Features, rows: Indices) -> Reals:
    """Features at rows as the C computes them, in float32: (rows, features)."""
    bank = feature_stage(features, np.arange(features.n_features), data.dt_s, np.float32)
    rested, values = np.zeros(1, dtype=np.intp), []
    for depth_m, at in zip(data.depths_m, data.split(rows), strict=True):
        before_m = estimate_history_m(depth_m)  # as `ensemble_data` assumes
        along_m = np.concatenate([before_m, depth_m]).astype(np.float32)
        values.append(bank.reference(along_m, rested)[len(before_m) + at])
    return np.concatenate(values)


def why_it_differs(regressor: Any, found: Regressor, error_n: float, peak_n: float) -> str:
    """Say why the C of a regressor errs by more than a ten-thousandth of the peak."""
    kind, errs = type(regressor).__name__, f"the C errs by {error_n:.2g} N of {peak_n:.3g} N"
    if isinstance(found, Linear):
        largest_n = np.abs(found.weights_n).max() / FEATURE_SCALE
        return (
            f"{kind}: its weights, up to {largest_n:.3g} N, cancel, and {errs} in single "
            "precision: fit with a stronger penalty, such as Ridge(1.0)"
        )
    if isinstance(found, Expression) and not found.jumps:
        return f"{kind}: {errs} in single precision: fit it with a smaller C"
    if isinstance(found, Forest) and error_n <= quantise_leaves(found).error_n:
        return (
            f"{kind}: {errs}, as the leaves of its {len(found.roots)} trees have 16 bits: fit "
            "fewer trees"
        )
    return (
        f"{kind} is no weighted sum of its trees: fit it with a squared or absolute "
        "error, without dart, linear_tree or an init of its own"
    )
