"""Smaller versions of a model that fit a scene's budget, measured on recordings."""

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from springpot import Model, Recording, Scene, SpringpotError, write_model
from springpot.codegen.arrays import rms
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.plan.plan import Plan
from springpot.codegen.plan.units import instruction_bound, state_bytes
from springpot.codegen.scene import Budget
from springpot.host.emission.result import Emission, over_budget
from springpot.host.native.replay import Replay, replayed_accuracy
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.smaller.pruned_models import Pruned, pruned_models
from springpot.trainer.features.values import feature_values
from springpot.trainer.models.compatibility import require_compatible
from springpot.trainer.models.contact import depth_m
from springpot.trainer.models.predict import predict_each_n, regressor_force

Emit = Callable[[Scene, Path, Path], Emission]
_BEST = 3
_EVALUATED = 4000  # samples that decide the order; what is reported is measured on all


@dataclass(frozen=True)
class Reduction:
    """What was left out, and what the scene then measures on its target."""

    what: str
    model: Model
    flash_bytes: int
    ram_bytes: int
    instructions: int | None
    rmse_n: float

    def line(self) -> str:
        ticks = "" if self.instructions is None else f", at most {self.instructions} instructions"
        return (
            f"{self.what}: {self.flash_bytes} bytes of flash, {self.ram_bytes} of RAM{ticks}, "
            f"RMSE {self.rmse_n:.4g} N"
        )


def best_reductions(
    scene: Scene, model: Model, recordings: Sequence[Recording], accept_unsafe: bool, emit: Emit
) -> list[Reduction]:
    """At most three reductions that fit, lowest error first; each size of leaf is there once.

    emit: writes a scene with a model's file into a folder, and measures it.
    """
    tick_s = make_plan(model, scene, accept_unsafe).dt_s
    for recording in recordings:
        require_compatible(recording, model, tick_s)
    candidates = list(pruned_models(model))
    if not candidates:
        return []
    evaluation = _evaluation(candidates[0].model, recordings)  # all have the same features
    ranked = sorted(candidates, key=lambda item: evaluation.error_n(item.model))
    found: list[Reduction] = []
    leaves_found = set()
    for pruned in ranked:
        if len(found) == _BEST:
            break
        if pruned.leaves in leaves_found:
            continue
        reduction = _measured(scene, pruned, recordings, emit)
        if reduction is not None:
            leaves_found.add(pruned.leaves)
            found.append(reduction)
    return sorted(found, key=lambda reduction: reduction.rmse_n)


@dataclass(frozen=True, eq=False)
class _Evaluation:
    """Some samples of the recordings: features (n, features), and what the trees must give, N."""

    values: Any
    target_n: Any

    def error_n(self, model: Model) -> float:
        assert model.regressor is not None
        return rms(regressor_force(model.regressor, self.values) - self.target_n)


def _evaluation(model: Model, recordings: Sequence[Recording]) -> _Evaluation:
    assert model.features is not None
    every = -(-sum(len(item.force_n) for item in recordings) // _EVALUATED)
    pieces = [(item, np.arange(0, len(item.force_n), every)) for item in recordings]
    values = [
        feature_values(model.features, depth_m(item, model.contact), model.dt_s, rows)
        for item, rows in pieces
    ]
    # What is not the trees': the passive part, which remembers through a session.
    others_n = predict_each_n(replace(model, features=None, regressor=None), pieces)
    force_n = np.concatenate([item.force_n[rows] for item, rows in pieces])
    return _Evaluation(np.concatenate(values), force_n - others_n)


def _measured(
    scene: Scene, pruned: Pruned, recordings: Sequence[Recording], emit: Emit
) -> Reduction | None:
    """Build it for its target and replay it here; None where it does not fit either."""
    free = replace(scene, budget=Budget())
    model = pruned.model
    plan = make_plan(model, scene, accept_unsafe=True)
    if _surely_over(plan, scene.budget):
        return None
    bound = instruction_bound(plan)
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        file = Path(scratch) / "model.spm"
        write_model(file, model)
        try:
            emission = emit(free, file, Path(scratch) / "c")
        except SpringpotError:
            return None
        if emission.footprint is None or over_budget(emission, scene.budget):
            return None
        replay = Replay(SceneLibrary(emission.folder))
        return Reduction(
            what=", ".join(pruned.what),
            model=model,
            flash_bytes=emission.footprint.flash_bytes,
            ram_bytes=emission.ram_bytes,
            instructions=None if bound is None else bound.tick,
            rmse_n=replayed_accuracy(plan, replay, recordings).rmse_n,
        )


def _surely_over(plan: Plan, budget: Budget) -> bool:
    """Whether what is known without a compiler is too much already."""
    bound = instruction_bound(plan)
    tables_bytes = 0 if plan.regressor is None else plan.regressor.table_bytes
    known = (
        (tables_bytes, budget.flash_bytes),
        (state_bytes(plan), budget.ram_bytes),
        (bound.tick if bound else 0, budget.tick_instructions),
    )
    return any(may is not None and has > may for has, may in known)
