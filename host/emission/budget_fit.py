"""Emission within a budget: as it is, or a forest made smaller, nothing fitted again.

What costs no error comes first: the window by exponentials and thresholds as 16-bit bins. Then
forests lose trees and small leaves, those that err least on some recordings first.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.errors import BudgetError, SpringpotError, UsageError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.features import FirBank
from springpot.codegen.model.forest import keep_trees, merge_leaves, quantise_thresholds
from springpot.codegen.model.model import Model
from springpot.codegen.model.regressors import Forest
from springpot.codegen.plan import state_bytes
from springpot.codegen.scene import Budget, Scene
from springpot.host.emission.emission import emit
from springpot.host.emission.result import Emission
from springpot.host.native.replay import Replay, replay_accuracy
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.toolchain import toolchain
from springpot.host.output import print_line
from springpot.trainer.recordings.recording import Recording

_TREES = (1.0, 0.8, 0.6, 0.4, 0.3, 0.2, 0.1, 0.05)  # shares of the trees
_LEAVES = (1, 2, 4, 8, 16, 32)  # leaves made one
_EVALUATED = 4000  # samples that decide the order; the line is measured on all


def emit_fitting(
    scene: Scene,
    model: Model,
    folder: Path,
    accept_unsafe: bool,
    recordings: Sequence[Recording],
    fit: bool,
) -> Emission:
    """Emit a scene; over its budget, with `fit`, emit the best smaller forest instead.

    recordings: what smaller forests are measured on. Raises BudgetError, exit status 4, where
    nothing fits; UsageError for `fit` without recordings; DataError for those of another rate.
    """
    if fit and not recordings:
        raise UsageError("--fit measures what it leaves out: give --recording REC")
    try:
        return emit(scene, model, folder, accept_unsafe)
    except BudgetError as error:
        if toolchain(scene.runtime.target) is None:
            raise  # nothing can be measured, of a smaller model neither
        if not fit:
            raise BudgetError(f"{error}; --fit --recording REC makes a forest smaller") from None
        refused = error
    for smaller in _order_by_error(scene, model, recordings, accept_unsafe):
        try:
            emission = emit(scene, smaller, folder, accept_unsafe)
        except SpringpotError:
            continue
        replay = Replay(SceneLibrary(emission.folder))
        accuracy = replay_accuracy(emission.plan, replay, recordings)
        print_line(
            f"fitted: {', '.join(smaller.provenance['left_out'])}: RMSE {accuracy.rmse_n:.4g} N"
        )
        return emission
    raise BudgetError(f"{refused}; no smaller version of this model fits: use another kind")


def _order_by_error(
    scene: Scene, model: Model, recordings: Sequence[Recording], accept_unsafe: bool
) -> Iterator[Model]:
    """Return the smaller models that may be within the budget, of least error first."""
    from springpot.trainer.models.predict import regressor_force, require_compatible

    tick_s = make_plan(model, scene, accept_unsafe).dt_s
    for recording in recordings:
        require_compatible(recording, model, tick_s)
    candidates = [one for one in _candidates(model) if not _exceeds_lower_bound(one, scene)]
    if not candidates:
        return
    values, target_n = _evaluation(candidates[0], recordings)  # all have the same features

    def error_n(smaller: Model) -> float:
        assert smaller.regressor is not None
        return rms(regressor_force(smaller.regressor, values) - target_n)

    yield from sorted(candidates, key=error_n)


def _candidates(model: Model) -> Iterator[Model]:
    """Yield every smaller version of a model on trees; provenance: what was `left_out` of it."""
    from springpot.trainer.features import fit_fast_fir_bank
    from springpot.trainer.models.rf_fd import MAX_TAPS

    features, whole = model.features, model.regressor
    if features is None or not isinstance(whole, Forest):
        return
    free: tuple[str, ...] = ()
    if isinstance(features, FirBank) and len(features.taps) <= MAX_TAPS:
        features, free = fit_fast_fir_bank(features), ("the window by exponentials",)
    if whole.quantisation is None:
        whole, free = (
            quantise_thresholds(whole, features.n_features),
            (*free, "thresholds in 16-bit steps"),
        )
    n_trees = len(whole.roots)
    for leaves in _LEAVES:
        pruned = merge_leaves(whole, leaves)
        larger = (f"leaves made one up to {leaves}",) if leaves > 1 else ()
        for count in sorted({max(1, round(share * n_trees)) for share in _TREES}):
            fewer = (f"{count} of {n_trees} trees",) if count < n_trees else ()
            if what := (*free, *larger, *fewer):
                forest = keep_trees(pruned, count)
                provenance = {**model.provenance, "left_out": list(what)}
                yield replace(model, features=features, regressor=forest, provenance=provenance)


def _evaluation(model: Model, recordings: Sequence[Recording]) -> tuple[Samples, Samples]:
    """Return features of some samples, (n, features), and what the trees must give, (n,), N."""
    from springpot.trainer.features import depth_features
    from springpot.trainer.models.depths import compute_depth_m
    from springpot.trainer.models.predict import predict_each_n

    assert model.features is not None
    every = -(-sum(len(item.force_n) for item in recordings) // _EVALUATED)
    pieces = [(item, np.arange(0, len(item.force_n), every)) for item in recordings]
    values = [
        depth_features(model.features, compute_depth_m(item, model.contact), model.dt_s, rows)
        for item, rows in pieces
    ]
    # What is not the trees': the passive part, which remembers through a session.
    others_n = predict_each_n(replace(model, features=None, regressor=None), pieces)
    force_n = np.concatenate([item.force_n[rows] for item, rows in pieces])
    return np.concatenate(values), force_n - np.concatenate(others_n)


def _exceeds_lower_bound(model: Model, scene: Scene) -> bool:
    """Return True if the sizes that are known without a compiler exceed the budget already."""
    plan = make_plan(model, replace(scene, budget=Budget()), accept_unsafe=True)
    tables_bytes = 0 if plan.regressor is None else plan.regressor.table_bytes
    known = ((tables_bytes, scene.budget.flash_bytes), (state_bytes(plan), scene.budget.ram_bytes))
    return any(may is not None and has > may for has, may in known)
