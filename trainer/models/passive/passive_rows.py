"""Rows that a passive model is fitted on: their folds, and those in which the object has let go."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from springpot.codegen.arrays import Flags, Indices, Samples
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import (
    Folds,
    build_cv_schemes,
    compute_fold_cells,
    geometric_mean,
    split_by_condition,
)
from springpot.trainer.models.passive.nonnegative import normal_equations
from springpot.trainer.models.training_set import TrainingSet

# Of the peak: what errors gain far below it no hand can tell, and a richer law pays for it where
# recordings end. A silicone in short presses: 0.11 -> 0.08 % held out, 0.23 -> 0.51 % in long ones.
IMPERCEPTIBLE_FRACTION = 0.002
_ROWS = 12_000
_ZERO_FORCE_FRACTION = 0.02  # of the peak: so little force is none
_MAX_ROUNDS = 3  # until the same samples are let go


@dataclass(frozen=True, eq=False)
class PassiveRows:
    """Numbers of the rows, their measured force, N, and the piece that each is in, all (rows,).

    families: ways to fold them. surface: the object has one, from which the tool can come off.
    separated: rows in which it has, (rows,). peak_n: greatest force, N. varied: presses differ in
    depth or speed; those of one kind show no law.
    """

    rows: Indices
    force_n: Samples
    cell: Indices
    families: Sequence[Folds]
    surface: bool
    peak_n: float
    varied: bool
    separated: Flags

    @cached_property
    def held_out(self) -> tuple[tuple[int, int], ...]:
        """List the folds that are held out: number of the family, and of the fold in it."""
        families = enumerate(self.families)
        return tuple((number, fold) for number, folds in families for fold in folds.tested)

    @cached_property
    def order(self) -> Indices:
        """Rows by their pieces, (rows,), in each of them those that have let go last."""
        return np.lexsort((self.separated, self.cell))

    @cached_property
    def cell_slices(self) -> list[slice]:
        """Slice each piece, in that order, without the rows that have let go."""
        begins = np.searchsorted(self.cell[self.order], np.arange(self.cell.max() + 1))
        kept = np.bincount(self.cell, ~self.separated).astype(np.intp)
        return list(map(slice, begins, begins + kept))

    @cached_property
    def in_fold(self) -> Flags:
        """Mark the rows, in that order, of each fold of `held_out`, (rows, folds)."""
        numbers = [self.families[k].number[self.order] == fold for k, fold in self.held_out]
        return np.stack(numbers, axis=1)

    @cached_property
    def _in_training(self) -> Samples:
        """1 for each piece that is in all rows, and in what is left without each fold, else 0."""
        shown = ~self.in_fold[[cell.start for cell in self.cell_slices]].T
        return np.vstack([np.ones(len(shown.T)), shown])

    def gram_by_fold(self, one: Samples, other: Samples) -> Samples:
        """Products of columns, in that order, of all rows and without folds: (1 + folds, k, l)."""
        cell_grams = np.stack([one[cell].T @ other[cell] for cell in self.cell_slices])
        return np.tensordot(self._in_training, cell_grams, 1)

    def errors_n(self, force_n: Samples) -> tuple[tuple[float, ...], Samples]:
        """Compute the geometric mean RMSE of each family of folds, and that of each fold, N.

        NaN: there is none. force_n: fitted without each fold of `held_out`, (rows, folds), in
        `order`; NaN: nothing was left.
        """
        if self.surface:
            force_n = np.maximum(force_n, 0.0)  # an object does not pull at its surface
        errors_n = np.where(self.in_fold, force_n - self.force_n[self.order, None], 0.0)
        with np.errstate(invalid="ignore"):
            folds_n = np.sqrt(np.sum(errors_n**2, axis=0) / np.sum(self.in_fold, axis=0))
        family = np.where(np.isnan(folds_n), -1, [number for number, _ in self.held_out])
        known = [k for k in np.unique(family).tolist() if k >= 0]
        return tuple(geometric_mean(folds_n[family == k]) for k in known), folds_n


def select_rows(data: TrainingSet, options: FitOptions) -> PassiveRows:
    """Choose the rows to fit on, evenly spaced or a share as asked, and put them into folds.

    A fit is linear in its weights, so that a row costs little; neighbours say the same, smoothed.
    """
    fraction = options.fraction
    rows = data.even_rows(_ROWS) if fraction is None else data.rows(fraction, 0)
    force_n = data.force_n(rows)
    families = build_cv_schemes(data, rows, options.seed)
    peak_n = max(float(np.abs(force_n).max()), 1e-12)
    surface = data.contact == "surface"
    varied = bool(split_by_condition(data, rows))
    let_go = np.zeros(len(rows), dtype=bool)
    return PassiveRows(
        rows, force_n, compute_fold_cells(families), families, surface, peak_n, varied, let_go
    )


def find_separated_rows(
    values: Samples, sums: Samples, force_n: Samples, peak_n: float, penalty: Samples
) -> Flags:
    """Find the rows in which the tool has left the object: force is 0 and a model would pull.

    values: (rows, k); terms are sums of these, (k, terms). Their force says nothing of how the
    object would pull: those rows are left out, and the others fitted again (censored regression:
    Tobin, Econometrica 26, 1958).
    """
    no_force = np.abs(force_n) < _ZERO_FORCE_FRACTION * peak_n
    others = normal_equations(values[~no_force], force_n[~no_force] / peak_n)
    separated, weights = np.zeros(len(no_force), dtype=bool), None
    for _ in range(_MAX_ROUNDS):
        kept, previous = no_force & ~separated, separated
        normal = others + normal_equations(values[kept], force_n[kept] / peak_n)
        weights = normal.transformed(sums).penalised(penalty).solve(near=weights)
        separated = no_force & (values @ (sums @ weights) < 0.0)
        if np.array_equal(separated, previous):
            break
    return separated
