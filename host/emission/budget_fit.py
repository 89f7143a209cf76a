"""Trims: smaller versions of a model that fit a scene's budget, measured on recordings.

What costs no error comes first: the window by exponentials and thresholds in 16-bit steps. Then
forests lose trees and small leaves; nothing is fitted again, so no training data is needed.
"""

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.errors import BudgetError, SpringpotError, UsageError
from springpot.codegen.forest.prune import fewer_trees, larger_leaves, stepped
from springpot.codegen.model.ir import FirBank, Forest, Model
from springpot.codegen.model.model_file import read_model, write_model
from springpot.codegen.plan.instructions import instruction_bound
from springpot.codegen.plan.model_stages import feature_count
from springpot.codegen.plan.plan import Plan, make_plan
from springpot.codegen.plan.units import state_bytes
from springpot.codegen.scene import Budget, Scene
from springpot.codegen.stages.forest import CompactForestStage
from springpot.host.console.output import say
from springpot.host.emission.emission import Emission, emit, over_budget
from springpot.host.metrics import rms
from springpot.host.native.replay import Replay, replayed_accuracy
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.toolchain import toolchain
from springpot.trainer.features.fast_fir import fast_fir_bank
from springpot.trainer.features.values import feature_values
from springpot.trainer.models.compatibility import refuse_other_frame
from springpot.trainer.models.passive_terms import hammerstein_force
from springpot.trainer.models.predict import regressor_force
from springpot.trainer.models.rf_fd import MOST_TAPS
from springpot.trainer.models.training_set import depth_m
from springpot.trainer.recordings.recording import Recording

_TREES = (1.0, 0.8, 0.6, 0.4, 0.3, 0.2, 0.1, 0.05)  # shares of the trees
_LEAVES = (1, 2, 4, 8, 16, 32)  # leaves made one
_BEST = 3
_MOST_TRIED = 40
_JUDGED = 4000  # samples that decide the order; what is told is measured on all
_MEANS = ("rf-fd", "rf-history", "hybrid")  # kinds whose force is the mean of their trees


@dataclass(frozen=True)
class Trim:
    """What was left out, and what the scene then measures on its target."""

    what: str
    model: Model
    flash_bytes: int
    ram_bytes: int
    instructions: int | None
    rmse_n: float

    def line(self) -> str:
        """For people."""
        ticks = "" if self.instructions is None else f", at most {self.instructions} instructions"
        return (
            f"{self.what}: {self.flash_bytes} bytes of flash, {self.ram_bytes} of RAM{ticks}, "
            f"RMSE {self.rmse_n:.4g} N"
        )


def emit_fitting(
    scene: Scene,
    model_file: Path,
    folder: Path,
    accept_unsafe: bool,
    recordings: Sequence[Recording],
    fit: bool,
) -> Emission:
    """Emit; where the scene does not fit its budget, tell the best trims, or apply the best.

    Raises BudgetError, exit status 4, where it does not fit and `fit` is not asked for, or where
    no trim fits; UsageError for `fit` without recordings; DataError for those of another rate.
    """
    if fit and not recordings:
        raise UsageError("--fit measures what it leaves out: give --recording REC")
    try:
        return emit(scene, model_file, folder, accept_unsafe)
    except BudgetError as error:
        if toolchain(scene.runtime.target) is None:
            raise  # nothing can be measured, of a trim neither
        if not recordings:
            raise BudgetError(f"{error}; give --recording REC to see what would fit") from None
        found = best_trims(scene, read_model(model_file), recordings, accept_unsafe)
        if not found:
            raise BudgetError(f"{error}; no trim of this model fits: use another kind") from None
        if not fit:
            for trim in found:
                say(f"would fit: {trim.line()}")
            raise BudgetError(f"{error}; {len(found)} trims would fit: add --fit") from None
    say(f"fitted: {found[0].line()}")
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        trimmed = Path(scratch) / "model.spm"
        write_model(trimmed, found[0].model)
        return emit(scene, trimmed, folder, accept_unsafe)


def best_trims(
    scene: Scene, model: Model, recordings: Sequence[Recording], accept_unsafe: bool
) -> list[Trim]:
    """At most three trims that fit, least error first; each size of leaf is there once."""
    tick_s = make_plan(model, scene, accept_unsafe).dt_s
    for recording in recordings:
        refuse_other_frame(recording, model, tick_s)
    candidates = list(_candidates(model))
    if not candidates:
        return []
    judges = _judges(candidates[0][2], recordings)  # all have the same features
    ranked = sorted(candidates, key=lambda item: judges.error_n(item[2]))
    found: list[Trim] = []
    leaves_found = set()
    for tried, (what, leaves, trimmed) in enumerate(ranked):
        if len(found) == _BEST or tried == _MOST_TRIED:
            break
        if leaves in leaves_found:
            continue
        trim = _measured(scene, trimmed, what, recordings, accept_unsafe)
        if trim is not None:
            leaves_found.add(leaves)
            found.append(trim)
    return sorted(found, key=lambda trim: trim.rmse_n)


def _candidates(model: Model) -> Iterator[tuple[str, int, Model]]:
    """What is left out, leaves made one, and the model without it."""
    free, whats = model, []
    if isinstance(model.features, FirBank) and len(model.features.taps) <= MOST_TAPS:
        free = replace(free, features=fast_fir_bank(model.features))
        whats.append("the window by exponentials")
    forest = model.regressor
    if not isinstance(forest, Forest):
        if whats:
            yield whats[0], 1, free
        return
    if forest.rounding is None:
        forest = stepped(forest, feature_count(model.features))
        whats.append("thresholds in 16-bit steps")
    for leaves in _LEAVES:
        pruned = larger_leaves(forest, leaves)
        for count in sorted({max(1, round(share * len(forest.roots))) for share in _TREES}):
            parts = [*whats]
            parts += [f"leaves made one up to {leaves}"] if leaves > 1 else []
            parts += [f"{count} of {len(forest.roots)} trees"] if count < len(forest.roots) else []
            if parts:
                smaller = fewer_trees(pruned, count, model.kind in _MEANS)
                facts = {**model.provenance, "left_out": parts}
                yield (
                    ", ".join(parts),
                    leaves,
                    replace(free, regressor=smaller, provenance=facts),
                )


@dataclass(frozen=True, eq=False)
class _Judges:
    """Some samples of the recordings: features (n, features), and what the trees must give, N."""

    values: Any
    wanted_n: Any

    def error_n(self, model: Model) -> float:
        assert model.regressor is not None
        return rms(regressor_force(model.regressor, self.values) - self.wanted_n)


def _judges(model: Model, recordings: Sequence[Recording]) -> _Judges:
    every = -(-sum(len(item.force_n) for item in recordings) // _JUDGED)
    values, wanted_n = [], []
    for item in recordings:
        rows = np.arange(0, len(item.force_n), every)
        depth = depth_m(item, model.contact)
        force_n = item.force_n[rows]
        if model.hammerstein is not None and model.hammerstein_adds:
            force_n = force_n - hammerstein_force(model.hammerstein, depth, model.dt_s, rows)
        assert model.features is not None
        values.append(feature_values(model.features, depth, model.dt_s, rows))
        wanted_n.append(force_n)
    return _Judges(np.concatenate(values), np.concatenate(wanted_n))


def _measured(
    scene: Scene, model: Model, what: str, recordings: Sequence[Recording], accept_unsafe: bool
) -> Trim | None:
    """Build it for its target and replay it here; None where it does not fit either."""
    free = replace(scene, budget=Budget())
    plan = make_plan(model, scene, accept_unsafe=True)
    if _surely_over(plan, scene.budget):
        return None
    bound = instruction_bound(plan)
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        file = Path(scratch) / "model.spm"
        write_model(file, model)
        try:
            emission = emit(free, file, Path(scratch) / "c", accept_unsafe)
        except SpringpotError:
            return None
        if emission.footprint is None or over_budget(emission, scene.budget):
            return None
        replay = Replay(SceneLibrary(emission.folder))
        return Trim(
            what=what,
            model=model,
            flash_bytes=emission.footprint.flash_bytes,
            ram_bytes=emission.ram_bytes,
            instructions=None if bound is None else bound.tick,
            rmse_n=replayed_accuracy(replay, recordings).rmse_n,
        )


def _surely_over(plan: Plan, budget: Budget) -> bool:
    """Whether what is known without a compiler is too much already."""
    bound, forest = instruction_bound(plan), plan.regressor
    nodes_bytes = 0
    if isinstance(forest, CompactForestStage):
        nodes_bytes = forest.forest.top.nbytes + forest.forest.nodes.nbytes
    known = (
        (nodes_bytes, budget.flash_bytes),
        (state_bytes(plan), budget.ram_bytes),
        (bound.tick if bound else 0, budget.tick_instructions),
    )
    return any(may is not None and has > may for has, may in known)
