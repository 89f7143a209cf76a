"""springpot's models as a scikit-learn regressor on whole recordings."""

import warnings
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.metrics import r2_score
from sklearn.utils.validation import check_is_fitted

from springpot import (
    DataError,
    Fit,
    FitOptions,
    Model,
    Recording,
    UsageError,
    check_recordings,
    kind_names,
)
from springpot.basics import Samples, errors_in_python, given_numbers, in_python
from springpot.modelling import Zero, extrapolation, fit_model, limited_n, zero_word
from springpot.validation import rms

Sequences = Sequence[ArrayLike | Recording]
_ARRAYS_S = 1e-3  # between samples of arrays, if nothing says how long


class PositionRegressor(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """Force of an object from the positions of a tool.

    A sample is a recording: X is a list of position sequences (m, positive into the object), y a
    list of force sequences (N, positive out of it), each of shape (n,) and of any length; or both
    are lists of `Recording`. So a cross-validation holds out whole recordings. Score it by default
    or with scoring=`neg_rmse_n`: scikit-learn's own take samples for outputs, and are refused.

    kind: a name of `springpot train --model`. dt_s: time between samples, s, which arrays do not
    say: another one is another material. By default that of given recordings; arrays alone are
    taken at 1 ms, and a UserWarning says so.
    zero: "none" or None where position 0 is the object's surface, else "first" or "min".
    Other parameters as in FitOptions. After fit: model_ is a Model, for `springpot.write_model` and
    `springpot.emit`, fit_ what it took.

    >>> X, y = [r.position_m for r in recordings], [r.force_n for r in recordings]
    >>> PositionRegressor("hammerstein", dt_s=1e-3).fit(X, y).score(X, y) > 0.99
    True
    """

    model_: Model
    fit_: Fit
    dt_s_: float

    def __init__(
        self,
        kind: str = "auto",
        dt_s: float | None = None,
        *,
        zero: Zero | None = "none",
        random_state: int = 0,
        fraction: float | None = None,
        window_s: float | None = None,
        smooth_s: float = FitOptions.smooth_s,
        trees: int = FitOptions.trees,
        leaf: int = FitOptions.leaf,
        n_centers: int = FitOptions.n_centers,
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

    def fit(self, X: Sequences, y: Sequences) -> "PositionRegressor":
        """Fit on recordings, checked as `springpot check` does; what is doubtful is a UserWarning.

        Training data is smoothed over smooth_s; fractions of rows are drawn from all recordings.
        Raises DataError for sequences that are none, or no object's, UsageError for a kind; both
        are ValueErrors.
        """
        if self.kind not in kind_names():
            raise UsageError(f"kind {self.kind!r}: use one of {', '.join(kind_names())}")
        _require_list(X, "X")
        _require_list(y, "y")
        _require_sequences(X, "X")
        _require_sequences(y, "y")
        self.dt_s_ = self._step_s([*X, *y])
        positions, forces = self._sequences(X, "X"), self._sequences(y, "y")
        if len(positions) != len(forces):
            raise DataError(f"{len(positions)} position and {len(forces)} force sequences: pair")
        recordings = [
            Recording(f"recording {i}", position_m, force_n, self.dt_s_, zero=zero_word(self.zero))
            for i, (position_m, force_n) in enumerate(zip(positions, forces, strict=True))
        ]
        quality = check_recordings(recordings)
        with errors_in_python():
            quality.refuse()
        said = dict.fromkeys(finding.text for finding in quality.findings)
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
        for line in dict.fromkeys((*said, *self.fit_.warnings)):
            warnings.warn(in_python(line), UserWarning, stacklevel=2)
        return self

    def predict(self, X: Sequences) -> list[Samples]:
        """Force along each position sequence, N, a list of arrays of shape (n,).

        At least 0 at a surface, as in C. A UserWarning says which go beyond the training presses.
        Raises DataError for positions as in millimetres.
        """
        check_is_fitted(self)
        _require_list(X, "X")
        found = _Forces()
        for i, position_m in enumerate(self._sequences(X, "X")):
            still_n = np.zeros_like(position_m)
            recording = Recording(f"X[{i}]", position_m, still_n, self.dt_s_, zero_word(self.zero))
            found.append(limited_n(self.model_, recording))
            if doubt := extrapolation(self.model_, recording):
                warnings.warn(doubt, UserWarning, stacklevel=2)
        return found

    def score(self, X: Sequences, y: Sequences, sample_weight: ArrayLike | None = None) -> float:
        """R^2 over all samples of all recordings; sample_weight: one a recording."""
        predicted, measured = self.predict(X), self._sequences(y, "y")
        _require_pairs(predicted, measured)
        weight = None
        if sample_weight is not None:
            lengths = [len(force_n) for force_n in measured]
            weight = np.repeat(np.asarray(sample_weight, dtype=np.float64), lengths)
        return float(
            r2_score(np.concatenate(measured), np.concatenate(predicted), sample_weight=weight)
        )

    def _step_s(self, values: Sequences) -> float:
        """Time between samples, s: as given, or that of the first recording."""
        if self.dt_s is not None:
            return self.dt_s
        known = [value.dt_s for value in values if isinstance(value, Recording)]
        if not known:
            warnings.warn(
                f"dt_s is not given: arrays are taken at {1e3 * _ARRAYS_S:g} ms a sample; give "
                "dt_s, the seconds between samples: another time is another material",
                UserWarning,
                stacklevel=3,
            )
        return (known or [_ARRAYS_S])[0]

    def _sequences(self, values: Sequences, name: str) -> list[Samples]:
        """Positions, for X, or forces, for y, of each recording, (n,)."""
        return [self._sequence(value, f"{name}[{i}]") for i, value in enumerate(values)]

    def _sequence(self, value: ArrayLike | Recording, name: str) -> Samples:
        if isinstance(value, Recording):
            if not np.isclose(value.dt_s, self.dt_s_, rtol=1e-3) or value.zero != zero_word(
                self.zero
            ):
                raise DataError(
                    f"{name}: {value.name} has dt_s={value.dt_s:g} and zero={value.zero!r}, the "
                    f"regressor dt_s={self.dt_s_:g} and zero={zero_word(self.zero)!r}: give it the "
                    "recordings' own, and recordings that agree"
                )
            return value.position_m if name.startswith("X") else value.force_n
        return _given_sequence(value, name)


def _require_list(values: Sequences, name: str) -> None:
    """Raise DataError for one recording, and for a table, which gives its columns' names."""
    if isinstance(values, Recording):
        raise DataError(f"{name} is one recording: give a list of them")
    if hasattr(values, "columns"):
        raise DataError(f"{name} is a table: make it one by Recording.from_frame, in a list")
    if not hasattr(values, "__len__"):
        kind = type(values).__name__
        raise DataError(f"{name} is a {kind}: give a list of sequences of shape (n,)")


def _require_sequences(values: Sequences, name: str) -> None:
    """Raise DataError for arrays of another shape, before anything is said of their time."""
    for i, value in enumerate(values):
        if not isinstance(value, Recording):
            _given_sequence(value, f"{name}[{i}]")


def _given_sequence(value: ArrayLike, name: str) -> Samples:
    found = given_numbers(value, name)
    if found.ndim != 1:
        one = f": for one recording, [{name[0]}]" if found.ndim == 0 else ""
        raise DataError(
            f"{name} has shape {found.shape}: {name[0]} is a list of sequences, one a "
            f"recording, each of shape (n,){one}"
        )
    return found


class _Forces(list[Samples]):
    """Forces of recordings: a list that is no table, whatever their lengths.

    scikit-learn would take recordings of one length for rows and their samples for outputs, and
    average errors over outputs.
    """

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        raise UsageError(
            "predict gives a list, one array of forces a recording, and no table: take one, "
            "predict(X)[0], or numpy.stack if all are of one length; in cross_val_score and the "
            "like, leave scoring out (R2 over all samples) or give scoring=springpot.neg_rmse_n"
        )


def neg_rmse_n(estimator: Any, X: Sequences, y: Sequences) -> float:
    """Minus the RMSE of a fitted estimator over all samples of all recordings, N.

    A scorer of scikit-learn, for `PositionRegressor` and pipelines that end with one.

    >>> regressor = PositionRegressor("springpot", dt_s=press.dt_s)
    >>> errors_n = cross_val_score(regressor, recordings, recordings, cv=2, scoring=neg_rmse_n)
    >>> bool(errors_n.max() < 0.0)
    True
    """
    forces = [one.force_n if isinstance(one, Recording) else given_numbers(one, "y") for one in y]
    predicted = estimator.predict(X)
    _require_pairs(predicted, forces)
    errors_n = np.concatenate(predicted) - np.concatenate(forces)
    return -rms(errors_n)


def _require_pairs(predicted: Sequence[Samples], measured: Sequence[Samples]) -> None:
    """Raise DataError if a recording has more positions than forces, or fewer."""
    lengths = [[len(samples) for samples in each] for each in (predicted, measured)]
    if lengths[0] != lengths[1]:
        raise DataError(f"recordings of {lengths[0]} positions and {lengths[1]} forces: pair them")
