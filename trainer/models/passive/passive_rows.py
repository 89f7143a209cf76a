"""Rows that a passive model is fitted on: their folds, and those in which the object has let go."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.arrays import Flags, Indices, Samples, rms
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import (
    Folds,
    fold_families,
    geometric_mean,
    held_out_whole,
    pieces,
)
from springpot.trainer.models.passive.nonnegative import Normal, normal_equations
from springpot.trainer.models.training_set import TrainingSet

# Of the peak: what errors gain far below it no hand can tell, and a richer law pays for it where
# recordings end. A silicone in short presses: 0.11 -> 0.08 % held out, 0.23 -> 0.51 % in long ones.
NEGLIGIBLE = 0.002
_ROWS = 12_000
_LET_GO = 0.02  # of the peak: so little force is none
_ROUNDS = 3  # until the same samples are let go


@dataclass(frozen=True, eq=False)
class PassiveRows:
    """Numbers of the rows, their measured force, N, and the piece that each is in, all (rows,).

    families: ways to fold them. surface: the object has one, from which the tool can come off.
    let_go: rows in which it has, (rows,). varied: presses differ in depth or speed; those of one
    kind show no law.
    """

    rows: Indices
    force_n: Samples
    piece: Indices
    families: Sequence[Folds]
    surface: bool
    peak_n: float
    varied: bool
    let_go: Flags

    def given_n(self, force_n: Samples) -> Samples:
        """Force that the C gives, (rows,), N: an object does not pull at its surface."""
        return np.maximum(force_n, 0.0) if self.surface else force_n

    def released(self, values: Samples, penalty: Samples) -> "PassiveRows":
        """The same with what has let go: where there is no force and a model would pull.

        Their force says nothing of how the object would pull: those rows are left out, and the
        others fitted again (censored regression: Tobin, Econometrica 26, 1958).
        """
        let_go = np.zeros(len(self.rows), dtype=bool)
        none = np.abs(self.force_n) < _LET_GO * self.peak_n
        for _ in range(_ROUNDS if self.surface else 0):
            normal = normal_equations(values[~let_go], self.force_n[~let_go] / self.peak_n)
            before = let_go
            let_go = none & (values @ normal.penalised(penalty).solve() < 0.0)
            if np.array_equal(let_go, before):
                break
        return replace(self, let_go=let_go)

    def parts(self, values: Samples) -> list[Normal]:
        """Normal equations of each piece, in shares of the peak, without what has let go."""
        share = self.force_n / self.peak_n
        pieces_held = ((self.piece == k) & ~self.let_go for k in range(int(self.piece.max()) + 1))
        return [normal_equations(values[its], share[its]) for its in pieces_held]

    def fold_errors_n(
        self, values: Samples, weights_without: Callable[[int, int], Samples | None]
    ) -> tuple[float, ...]:
        """Geometric mean of the RMSEs on each family's held-out folds, (families,), N.

        weights_without: weights, N, fitted without a fold of a family; None if nothing is left.
        """
        means = []
        for number, folds in enumerate(self.families):
            without = {fold: weights_without(number, fold) for fold in folds.tested}
            known = {fold: its for fold, its in without.items() if its is not None}
            given_n = self.given_n(values @ np.stack(list(known.values()), axis=1))
            errors = []
            for k, fold in enumerate(known):
                out = folds.number == fold
                if out.any():
                    errors.append(rms(given_n[out, k] - self.force_n[out]))
            if errors:
                means.append(geometric_mean(errors))
        return tuple(means)


def passive_rows(data: TrainingSet, options: FitOptions) -> PassiveRows:
    """Evenly spaced rows, or the share of them that was asked for, in folds.

    A fit is linear in its weights, so that a row costs little; neighbours say the same, smoothed.
    """
    rows = data.even_rows(_ROWS)
    if options.fraction is not None:
        rows = data.rows(options.fraction, 0)
    force_n = data.force_n(rows)
    families = fold_families(data, rows, options.seed)
    peak_n = max(float(np.abs(force_n).max()), 1e-12)
    surface = data.contact == "surface"
    varied = bool(held_out_whole(data, rows))
    let_go = np.zeros(len(rows), dtype=bool)
    return PassiveRows(rows, force_n, pieces(families), families, surface, peak_n, varied, let_go)
