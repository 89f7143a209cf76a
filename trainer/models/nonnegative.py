"""Non-negative least squares from normal equations, and the removal of terms that add little."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from springpot.codegen.arrays import Samples

_TRIED = 5  # terms of lowest contribution tried for removal at each step
_RIDGE = 1e-10  # of the mean diagonal: keeps the factor of nearly equal columns real


@dataclass(frozen=True, eq=False)
class Normal:
    """Normal equations of rows A w = y: A'A, (terms, terms), A'y, (terms,), y'y, number of rows."""

    matrix: Samples
    vector: Samples
    square: float
    rows: int

    def __add__(self, other: "Normal") -> "Normal":
        return Normal(
            self.matrix + other.matrix,
            self.vector + other.vector,
            self.square + other.square,
            self.rows + other.rows,
        )

    def solve(self, active: NDArray[np.bool_] | None = None) -> Samples:
        """Weights >= 0 of lowest error, (terms,); 0 for terms that are not active.

        With A'A = L L', |A w - y|^2 is |L'w - L^-1 A'y|^2 and a constant: a system as small as the
        terms are few, whatever the number of rows.
        """
        chosen = np.ones(len(self.vector), dtype=bool) if active is None else active
        # Columns scaled to length 1, so that the ridge is the same share of each.
        size = np.sqrt(np.maximum(np.diag(self.matrix), 1e-300))
        scaled = self.matrix / np.outer(size, size)
        scaled = scaled[np.ix_(chosen, chosen)]
        factor = np.linalg.cholesky(scaled + _RIDGE * np.eye(len(scaled)))
        target = np.linalg.solve(factor, (self.vector / size)[chosen])
        weights = np.zeros(len(self.vector))
        weights[chosen] = nnls(factor.T, target, maxiter=30 * len(target))[0]
        result: Samples = weights / size
        return result

    def error(self, weights: Samples) -> float:
        """Sum of squared errors of weights on these rows; never below 0 by rounding."""
        crossed = float(weights @ self.vector)
        return max(self.square - 2.0 * crossed + float(weights @ self.matrix @ weights), 0.0)

    def rmse(self, weights: Samples) -> float:
        return float(np.sqrt(self.error(weights) / self.rows))


def normal_equations(columns: Samples, target: Samples) -> Normal:
    """Normal equations of columns (rows, terms) and a target (rows,): they add up over rows."""
    return Normal(columns.T @ columns, columns.T @ target, float(target @ target), len(target))


def sparse_solve(normal: Normal, loss: float) -> Samples:
    """Weights >= 0 with few terms, (terms,): the RMSE stays within a share `loss` of the lowest.

    Backward elimination: of the terms that contribute least, the one that raises the error least is
    removed, and the others are fitted again. The limit is that of the full fit: losses do not add
    up.
    """
    best = normal.solve()
    limit = (1.0 + loss) * normal.rmse(best)
    size = np.sqrt(np.maximum(np.diag(normal.matrix), 0.0))
    weights = best
    while True:
        active = weights > 0.0
        trials = []
        smallest = np.argsort(np.where(active, weights * size, np.inf))[:_TRIED]
        for term in smallest[active[smallest]]:
            without = active.copy()
            without[term] = False
            if without.any():
                trial = normal.solve(without)
                trials.append((normal.rmse(trial), trial))
        if not trials:
            return weights
        error, trial = min(trials, key=lambda pair: pair[0])
        if error > limit:
            return weights
        weights = trial
