"""Smaller versions of a fitted model, without its training data: nothing is fitted again.

What costs no error comes first: the window by exponentials and thresholds as 16-bit bins. Then
forests lose trees and small leaves.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import singledispatch

from springpot import Model
from springpot.host.wings.smaller.pruning import fewer_trees, larger_leaves, quantised
from springpot.modelling import MAX_TAPS, Features, FirBank, Forest, Regressor, fast_fir_bank

_TREES = (1.0, 0.8, 0.6, 0.4, 0.3, 0.2, 0.1, 0.05)  # shares of the trees
_LEAVES = (1, 2, 4, 8, 16, 32)  # leaves made one


@dataclass(frozen=True, eq=False)
class Pruned:
    """Smaller model: what was left out, how many leaves were made one, and the model."""

    what: tuple[str, ...]
    leaves: int
    model: Model


def pruned_models(model: Model) -> Iterator[Pruned]:
    """Smaller versions of a model; none where nothing can be left out."""
    if model.features is None or model.regressor is None:
        return
    features, free = cheaper_features(model.features)
    for what, leaves, regressor in smaller_regressors(model.regressor, model.features.n_features):
        parts = (*free, *what)
        if parts:
            metadata = {**model.provenance, "left_out": list(parts)}
            smaller = replace(model, features=features, regressor=regressor, provenance=metadata)
            yield Pruned(parts, leaves, smaller)


@singledispatch
def cheaper_features(features: Features) -> tuple[Features, tuple[str, ...]]:
    """The same features for fewer instructions, and what was done; themselves by default."""
    return features, ()


@cheaper_features.register
def _cheaper_window(bank: FirBank) -> tuple[Features, tuple[str, ...]]:
    if len(bank.taps) > MAX_TAPS:
        return bank, ()
    return fast_fir_bank(bank), ("the window by exponentials",)


@singledispatch
def smaller_regressors(
    regressor: Regressor, n_features: int
) -> Iterator[tuple[tuple[str, ...], int, Regressor]]:
    """Yield what is left out, leaves made one, and the regressor without it; itself by default."""
    yield (), 1, regressor


@smaller_regressors.register
def _smaller_forests(
    forest: Forest, n_features: int
) -> Iterator[tuple[tuple[str, ...], int, Regressor]]:
    free = () if forest.quantisation is not None else ("thresholds in 16-bit steps",)
    forest = quantised(forest, n_features)
    n_trees = len(forest.roots)
    for leaves in _LEAVES:
        pruned = larger_leaves(forest, leaves)
        larger = (f"leaves made one up to {leaves}",) if leaves > 1 else ()
        for count in sorted({max(1, round(share * n_trees)) for share in _TREES}):
            fewer = (f"{count} of {n_trees} trees",) if count < n_trees else ()
            yield (*free, *larger, *fewer), leaves, fewer_trees(pruned, count)
