"""The passive part of a model, chosen by cross-validated error: curves of the depth, and rates."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.model import Basis, Hammerstein
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import Folds, fold_families, geometric_mean, pieces
from springpot.trainer.models.passive.nonnegative import Normal, normal_equations, sparse_solve
from springpot.trainer.models.passive.passive_terms import (
    FEWEST_BY_DEPTH,
    Shape,
    Terms,
    columns,
    standard_terms,
    to_model,
)
from springpot.trainer.models.training_set import TrainingSet

# Penalties tried on the roughness of ramps: the smoothest curves unless others have a tenth less
# cross-validated error. What few recordings tell is not enough to choose by hundredths.
PENALTIES: dict[Basis, tuple[float, ...]] = {"powers": (0.0,), "ramps": (1e-3, 1e-4, 1e-5, 1e-6)}
BETTER = 0.9
# What curves and rates are tried, each for a tenth less error than the ones before.
PLAIN = (Shape("powers"), Shape("ramps"), Shape("ramps", stretch=12.0))
RATE_RATIOS = (16.0, 1.0 / 16.0)  # relaxing faster at the surface, or deep inside
_SPARSE_LOSS = 0.005


@dataclass(frozen=True, eq=False)
class PassiveChoice:
    """Terms and a penalty on their roughness.

    error_n: RMSE over held-out folds, N. parts: normal equations of the pieces of the rows that
    all folds are made of; piece, families: of the rows.
    """

    error_n: float
    terms: Terms
    penalty: float
    parts: list[Normal]
    piece: Indices
    families: Sequence[Folds]

    def model(self) -> Hammerstein:
        """Fitted to all rows, with as few branches and stops as serve."""
        normal = _penalised(self.parts, self.penalty, self.terms)
        return to_model(self.terms, sparse_solve(normal, self.terms.blocks, _SPARSE_LOSS))

    def weights_without(self, family: int, fold: int) -> Samples:
        """Fitted without a fold of a family, (terms,)."""
        kept, _ = _apart(self.parts, self.piece, self.families[family], fold)
        return _penalised(kept, self.penalty, self.terms).solve()


def fit_passive(data: TrainingSet, options: FitOptions) -> tuple[Hammerstein, int, float]:
    """The passive part, the rows used, and its cross-validated RMSE, N; see `passive_choice`."""
    return timed_passive(data, options)[0]


def timed_passive(
    data: TrainingSet, options: FitOptions
) -> tuple[tuple[Hammerstein, int, float], float]:
    """`fit_passive` and its seconds, once for the options that decide it."""
    choice, chosen_s = passive_choice(data, options)
    key = ("passive model", options.fraction, options.seed, options.poles)
    model, model_s = data.once(key, choice.model)
    return (model, len(choice.piece), choice.error_n), chosen_s + model_s


def term_columns(terms: Terms, data: TrainingSet, rows: Indices) -> Samples:
    """Values of all terms at rows of all recordings, (rows, terms)."""
    return data.along(rows, lambda depth, at: columns(terms, depth, data.dt_s, at))


def passive_choice(data: TrainingSet, options: FitOptions) -> tuple[PassiveChoice, float]:
    """The terms of lowest cross-validated error, by steps, and the seconds that it took.

    Done once for the options that decide it. A bias only where the tool never leaves the object:
    at a surface the force is 0 by itself.
    """
    key = ("passive", options.fraction, options.seed, options.poles)
    return data.once(key, lambda: _chosen(data, options))


def _chosen(data: TrainingSet, options: FitOptions) -> PassiveChoice:
    # Linear in its weights, so that a row costs little: more of them than trees are fitted on.
    rows = data.many_rows() if options.fraction is None else data.rows(options.fraction, 0)
    force_n = data.force_n(rows)
    families = fold_families(data, rows, options.seed)
    piece = pieces(families)

    def tried(shape: Shape) -> PassiveChoice:
        terms = standard_terms(data, shape, data.contact == "always", options.poles)
        values = term_columns(terms, data, rows)
        # Normal equations add up over rows: each piece is made once, and every fold and penalty is
        # a sum of pieces, (sum A'A) w = sum A'y, whatever the number of rows.
        parts = [
            normal_equations(values[piece == k], force_n[piece == k])
            for k in range(int(piece.max()) + 1)
        ]
        errors = (
            (_cross_validated(parts, families, piece, penalty, terms), penalty)
            for penalty in PENALTIES[shape.basis]
        )
        choices = (
            PassiveChoice(error_n, terms, penalty, parts, piece, families)
            for error_n, penalty in errors
        )
        return reduce(_better, choices)

    # By steps and not the lowest of all: with few recordings hundredths are chance, and a simpler
    # shape extrapolates better.
    plain = [tried(shape) for shape in PLAIN]
    best = reduce(_better, plain)
    ramps = [choice for choice in plain if choice.terms.shape.basis == "ramps"]
    if ramps and options.poles >= FEWEST_BY_DEPTH:
        stretch = reduce(_better, ramps).terms.shape.stretch
        for ratio in RATE_RATIOS:
            best = _better(best, tried(Shape("ramps", stretch, ratio)))
    return best


def _better(best: PassiveChoice, other: PassiveChoice) -> PassiveChoice:
    return other if other.error_n < BETTER * best.error_n else best


def _cross_validated(
    parts: list[Normal], families: Sequence[Folds], piece: Indices, penalty: float, terms: Terms
) -> float:
    """RMSE over the held-out folds, N: geometric mean in each family, then of all."""
    means = []
    for folds in families:
        errors = []
        for fold in folds.tested:
            kept, held = _apart(parts, piece, folds, fold)
            if kept and held:
                weights = _penalised(kept, penalty, terms).solve()
                errors.append(reduce(add, held).rmse(weights))
        if errors:
            means.append(geometric_mean(errors))
    return geometric_mean(means) if means else 0.0


def _apart(
    parts: list[Normal], piece: Indices, folds: Folds, fold: int
) -> tuple[list[Normal], list[Normal]]:
    """The pieces outside a fold, and those in it."""
    _, first = np.unique(piece, return_index=True)
    pairs = list(zip(parts, folds.number[first], strict=True))
    return [part for part, its in pairs if its != fold], [p for p, its in pairs if its == fold]


def _penalised(parts: list[Normal], penalty: float, terms: Terms) -> Normal:
    return reduce(add, parts).penalised(penalty * terms.roughness())
