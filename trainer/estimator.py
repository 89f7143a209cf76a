"""springpot's models as a scikit-learn regressor on whole recordings."""

import warnings
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.metrics import r2_score
from sklearn.utils.validation import check_is_fitted

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.model.model import Model
from springpot.trainer.kinds import fit_model, kind_names
from springpot.trainer.models.fit import PAPER_CENTERS, PAPER_LEAF, PAPER_TREES, Fit, FitOptions
from springpot.trainer.models.limited import limited_n
from springpot.trainer.paper import PAPER_SMOOTH_S
from springpot.trainer.recordings.quality.report import check_recordings
from springpot.trainer.recordings.recording import Recording, Zero


class PositionRegressor(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """Force of an object from the positions of a tool.

    A sample is a recording: X is a list of position sequences (m, positive into the object), y a
    list of force sequences (N, positive out of it), each of shape (n,) and of any length. So a
    cross-validation holds out whole recordings.

    kind: a name of `springpot train --model`. dt_s: time between samples.
    zero: "none" where position 0 is the object's surface, else "first" or "min".
    Other parameters as in FitOptions. After fit: model_ is a Model, for `springpot.write_model` and
    `springpot.emit`, fit_ what it took.

    >>> X, y = [r.position_m for r in recordings], [r.force_n for r in recordings]
    >>> PositionRegressor("hammerstein").fit(X, y).score(X, y) > 0.99
    True
    """

    model_: Model
    fit_: Fit

    def __init__(
        self,
        kind: str = "rf-fd",
        dt_s: float = 1e-3,
        *,
        zero: Zero = "none",
        random_state: int = 0,
        fraction: float | None = None,
        window_s: float | None = None,
        smooth_s: float = PAPER_SMOOTH_S,
        trees: int = PAPER_TREES,
        leaf: int = PAPER_LEAF,
        n_centers: int = PAPER_CENTERS,
        centers: Literal["farthest", "greedy"] = "farthest",
        monotone: bool = False,
    ) -> None:
        self.kind = kind
        self.dt_s = dt_s
        self.zero = zero
        self.random_state = random_state
        self.fraction = fraction
        self.window_s = window_s
        self.smooth_s = smooth_s
        self.trees = trees
        self.leaf = leaf
        self.n_centers = n_centers
        self.centers = centers
        self.monotone = monotone

    def fit(self, X: Sequence[ArrayLike], y: Sequence[ArrayLike]) -> "PositionRegressor":
        """Fit on recordings, checked as `springpot check` does; what is doubtful is a UserWarning.

        Training data is smoothed over smooth_s; fractions of rows are drawn from all recordings.
        Raises DataError for sequences that are none, or no object's, UsageError for a kind; both
        are ValueErrors.
        """
        if self.kind not in kind_names():
            raise UsageError(f"kind {self.kind!r}: use one of {', '.join(kind_names())}")
        positions, forces = _sequences(X, "X"), _sequences(y, "y")
        if len(positions) != len(forces):
            raise DataError(f"{len(positions)} position and {len(forces)} force sequences: pair")
        recordings = [
            Recording(f"recording {i}", position_m, force_n, self.dt_s, zero=self.zero)
            for i, (position_m, force_n) in enumerate(zip(positions, forces, strict=True))
        ]
        quality = check_recordings(recordings)
        quality.refuse()
        for finding in quality.findings:
            warnings.warn(finding.line, stacklevel=2)
        options = FitOptions(
            seed=self.random_state,
            fraction=self.fraction,
            window_s=self.window_s,
            smooth_s=self.smooth_s,
            trees=self.trees,
            leaf=self.leaf,
            n_centers=self.n_centers,
            centers=self.centers,
            monotone=self.monotone,
        )
        self.fit_ = fit_model(self.kind, self.kind, recordings, options)
        self.model_ = self.fit_.model
        return self

    def predict(self, X: Sequence[ArrayLike]) -> list[Samples]:
        """Force along each position sequence, N, a list of arrays of shape (n,).

        At least 0 at a surface, as in C. Raises DataError for positions as in millimetres.
        """
        check_is_fitted(self)
        return [
            limited_n(
                self.model_,
                Recording(f"X[{i}]", position_m, np.zeros_like(position_m), self.dt_s, self.zero),
            )
            for i, position_m in enumerate(_sequences(X, "X"))
        ]

    def score(
        self, X: Sequence[ArrayLike], y: Sequence[ArrayLike], sample_weight: ArrayLike | None = None
    ) -> float:
        """R^2 over all samples of all recordings; sample_weight: one a recording."""
        predicted, measured = self.predict(X), _sequences(y, "y")
        weight = None
        if sample_weight is not None:
            lengths = [len(force_n) for force_n in measured]
            weight = np.repeat(np.asarray(sample_weight, dtype=np.float64), lengths)
        return float(
            r2_score(np.concatenate(measured), np.concatenate(predicted), sample_weight=weight)
        )


def _sequences(values: Sequence[Any], name: str) -> list[Samples]:
    sequences = [np.asarray(value, dtype=np.float64) for value in values]
    for i, sequence in enumerate(sequences):
        if sequence.ndim != 1:
            raise DataError(
                f"{name}[{i}] has shape {sequence.shape}: {name} is a list of sequences, one a "
                "recording, each of shape (n,)"
            )
    return sequences
