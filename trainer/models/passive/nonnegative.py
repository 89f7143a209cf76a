"""Non-negative least squares from normal equations, and the removal of terms that add little."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dposv
from scipy.optimize import nnls

from springpot.codegen.arrays import Flags, Indices, Samples

_MAX_TRIALS = 5  # blocks of lowest contribution tried for removal at each step
_RIDGE = 1e-8  # of the diagonal: keeps the factor of nearly equal columns real
_GRADIENT_TOLERANCE = 1e-12  # of a gradient
_MAX_BLOCK_RETRIES, _MAX_PIVOTS_PER_TERM = 3, 3  # tries without progress; solutions for each term
_MIN_DIAGONAL = 1e-12  # a row: a column that the rows hardly see gets no weight, not a huge one


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

    def transformed(self, sums: Samples) -> "Normal":
        """Return the equations of columns that are sums of these, (terms, columns)."""
        return Normal(sums.T @ self.matrix @ sums, sums.T @ self.vector, self.square, self.rows)

    def penalised(self, penalty: Samples) -> "Normal":
        """Add w' penalty w, (terms, terms), to the squared error of each row."""
        return Normal(self.matrix + self.rows * penalty, self.vector, self.square, self.rows)

    def solve(self, active: Flags | None = None, near: Samples | None = None) -> Samples:
        """Find the weights >= 0 of lowest error, (terms,); 0 for terms that are not active.

        near: weights of a problem like this one, (terms,): the search begins at their signs.
        """
        chosen = np.ones(len(self.vector), dtype=bool) if active is None else active
        # Columns scaled to length 1, so that the ridge is the same share of each.
        size = self._column_norms
        scaled = (self.matrix / np.outer(size, size))[np.ix_(chosen, chosen)]
        weights = np.zeros(len(self.vector))
        begin = np.zeros(len(scaled), dtype=bool) if near is None else near[chosen] > 0.0
        weights[chosen] = _solve_nonnegative(
            scaled + _RIDGE * np.eye(len(scaled)), (self.vector / size)[chosen], begin
        )
        return weights / size

    @property
    def _column_norms(self) -> Samples:
        return np.sqrt(np.maximum(np.diag(self.matrix), _MIN_DIAGONAL * self.rows))

    def contribution(self, weights: Samples) -> Samples:
        """Compute the share of each term in what the weights give, (terms,)."""
        return weights * self._column_norms

    def error(self, weights: Samples) -> float:
        """Sum the squared errors of weights on these rows, with the penalty if there is one."""
        crossed = float(weights @ self.vector)
        return max(self.square - 2.0 * crossed + float(weights @ self.matrix @ weights), 0.0)

    def rmse(self, weights: Samples) -> float:
        return float(np.sqrt(self.error(weights) / self.rows))


def _solve_nonnegative(matrix: Samples, vector: Samples, free: Flags) -> Samples:
    """Minimise w' matrix w / 2 - w' vector over w >= 0, (terms,); positive definite matrix.

    free: the terms that may be above 0 at first, (terms,).
    Block principal pivoting (Portugal, Judice, Vicente, Math. Comput. 63, 1994): a term is free or
    0; all that are on the wrong side change at once, and the last one alone where that does not
    lead to fewer. Where it takes too long, active sets one by one (Lawson, Hanson, 1974), for which
    with matrix = L L' the same is |L'w - L^-1 vector|^2: a system as small as the terms are few.
    """
    weights, best_infeasible, block_retries = (
        np.zeros(len(vector)),
        len(vector) + 1,
        _MAX_BLOCK_RETRIES,
    )
    for _ in range(_MAX_PIVOTS_PER_TERM * len(vector)):
        weights = np.zeros(len(vector))
        if free.any():
            _, weights[free], failed = dposv(matrix[np.ix_(free, free)], vector[free])
            if failed:
                break
        gradient = vector - matrix @ weights
        infeasible = np.where(free, weights < 0.0, gradient > _GRADIENT_TOLERANCE)
        n_infeasible = int(np.count_nonzero(infeasible))
        if n_infeasible == 0:
            return weights
        if n_infeasible < best_infeasible:
            best_infeasible, block_retries = n_infeasible, _MAX_BLOCK_RETRIES
        elif block_retries > 0:
            block_retries -= 1
        else:
            infeasible[: np.flatnonzero(infeasible)[-1]] = False
        free = free ^ infeasible
    factor = np.linalg.cholesky(matrix)
    return nnls(factor.T, np.linalg.solve(factor, vector), maxiter=30 * len(vector))[0]


def normal_equations(columns: Samples, target: Samples) -> Normal:
    """Normal equations of columns (rows, terms) and a target (rows,): they add up over rows."""
    return Normal(columns.T @ columns, columns.T @ target, float(target @ target), len(target))


def sparse_solve(
    normal: Normal, blocks: Indices, loss: float, near: Samples | None = None
) -> Samples:
    """Find weights >= 0 in few blocks, (terms,): the RMSE is within a share `loss` of the lowest.

    blocks: number of each term's block, (terms,): what costs time in C is a block, not a term.
    Backward elimination: of the blocks that contribute least, the one that raises the error least
    is removed, and the others are fitted again. The limit is that of the full fit: losses do not
    add up. near: as in `Normal.solve`.
    """
    weights = normal.solve(near=near)
    limit = (1.0 + loss) * normal.rmse(weights)
    while True:
        size = np.bincount(blocks, normal.contribution(weights))
        present = size[blocks] > 0.0
        trials = []
        for block in np.argsort(np.where(size > 0.0, size, np.inf))[:_MAX_TRIALS]:
            without = present & (blocks != block)
            if size[block] > 0.0 and without.any():
                trial = normal.solve(without, weights)
                trials.append((normal.rmse(trial), trial))
        if not trials:
            return weights
        error, trial = min(trials, key=lambda pair: pair[0])
        if error > limit:
            return weights
        weights = trial
