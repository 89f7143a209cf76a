"""The passive part of a model, chosen by cross-validated error: curves, rates, flow and damage."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, reduce
from math import hypot
from operator import add

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.passive import Hammerstein
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import geometric_mean
from springpot.trainer.models.passive.growth import growing
from springpot.trainer.models.passive.nonnegative import Normal, sparse_solve
from springpot.trainer.models.passive.passive_force import with_memory
from springpot.trainer.models.passive.passive_rows import NEGLIGIBLE, PassiveRows, passive_rows
from springpot.trainer.models.passive.passive_terms import (
    DEPTH_POLES,
    Terms,
    plain_terms,
    to_model,
    with_damage,
    with_flow,
    with_rates,
)
from springpot.trainer.models.passive.recovery import SPARSE_LOSS, recovering
from springpot.trainer.models.passive.term_values import added_columns, term_columns
from springpot.trainer.models.training_set import TrainingSet

NODES = (9, 13, 25)  # of each curve; the last where a layer is pressed flat within a few hundredths
PENALTIES = (1e-3, 1e-4, 1e-5)  # on the roughness of curves; forces in shares of the peak
_ROUGHER = 1.01  # times less error is what a penalty ten times lower has to bring,
_UNCOVERED = 13  # nodes, between which rows may be missing
_FINER = (1.0, 1.01, 1.1)  # and more nodes: 25 cost flash
BETTER, NO_WORSE = 0.9, 1.02  # times the error, in all and in each family, of a richer law
RATE_RATIOS = (16.0, 1.0 / 16.0)  # relaxing faster at the surface, or deep inside


@dataclass(frozen=True, eq=False)
class PassiveChoice:
    """Terms and a penalty on their roughness; law: the names of what they have beside plain ones.

    errors_n: RMSE over held-out folds, N, of each family. parts: normal equations of the pieces of
    the rows, in shares of the peak.
    """

    law: tuple[str, ...]
    terms: Terms
    penalty: float
    errors_n: Sequence[float]
    parts: Sequence[Normal]
    rows: PassiveRows

    @property
    def error_n(self) -> float:
        """Geometric mean over the families of folds, N."""
        return geometric_mean(list(self.errors_n)) if self.errors_n else 0.0

    @cached_property
    def _all_weights(self) -> Samples:
        return _penalised(self.parts, self.penalty, self.terms).solve()

    def weights(self) -> Samples:
        """Fitted to all rows, with as few branches, stops and curves as serve, (terms,), N."""
        normal = _penalised(self.parts, self.penalty, self.terms)
        return self.rows.peak_n * sparse_solve(normal, self.terms.blocks, SPARSE_LOSS)

    def model(self, data: TrainingSet) -> Hammerstein:
        """Build the model; its surface recovers and its slopes grow, if the object's do."""
        weights = self.weights()
        model = recovering(to_model(self.terms, weights), self.terms, self.penalty, self.rows, data)
        model = growing(model, self.terms, weights, self.penalty, self.rows, data)
        return with_memory(model, data)

    def weights_without(self, family: int, fold: int) -> Samples | None:
        """Fitted without a fold of a family, (terms,), N; None if that leaves no rows."""
        _, first = np.unique(self.rows.piece, return_index=True)
        numbers = self.rows.families[family].number[first]
        others = [part for part, its in zip(self.parts, numbers, strict=True) if its != fold]
        if sum(part.rows for part in others) == 0:
            return None
        normal = _penalised(others, self.penalty, self.terms)
        return self.rows.peak_n * normal.solve(near=self._all_weights)

    def judged(self, values: Samples) -> "PassiveChoice":
        """The same with its errors; values of its terms at all rows, (rows, terms)."""
        return replace(self, errors_n=self.rows.fold_errors_n(values, self.weights_without))


def fit_passive(data: TrainingSet, options: FitOptions) -> tuple[Hammerstein, int, float]:
    """Fit the passive part beside another: it, how many rows it used, its cross-validated RMSE, N.

    Of seed and poles of the options, whatever share of the rows the other is fitted on;
    `passive_choice` says how.
    """
    return timed_passive(data, replace(options, fraction=None))[0]


def timed_passive(
    data: TrainingSet, options: FitOptions
) -> tuple[tuple[Hammerstein, int, float], float]:
    """`fit_passive` and its seconds, once for the options that decide it."""
    choice, chosen_s = passive_choice(data, options)

    key = ("passive model", options.fraction, options.seed, options.poles)
    model, model_s = data.once(key, lambda: choice.model(data))
    return (model, len(choice.rows.rows), choice.error_n), chosen_s + model_s


def passive_choice(data: TrainingSet, options: FitOptions) -> tuple[PassiveChoice, float]:
    """The terms of lowest cross-validated error, by steps, and the seconds that it took.

    Done once for the options that decide it.
    """
    key = ("passive", options.fraction, options.seed, options.poles)
    return data.once(key, lambda: _chosen(data, options))


def _chosen(data: TrainingSet, options: FitOptions) -> PassiveChoice:
    """First curves and a penalty, then what the object does besides, then the curves once more.

    By steps and not the lowest of all: with few recordings hundredths are chance, and a simpler law
    extrapolates better.
    """
    every = passive_rows(data, options)

    @cache
    def of_nodes(nodes: int) -> Laws:
        return Laws(plain_terms(data, nodes, options.poles), every, data)

    laws, plain = _smoothest(of_nodes, ())
    if not every.varied or options.poles < DEPTH_POLES:
        return plain

    def tried(*names: str) -> PassiveChoice:
        return laws.choices(names, (plain.penalty,))[0]

    rates = [tried(name) for name in laws.rates]
    (rate,) = min(rates, key=lambda choice: choice.error_n).law
    best = reduce(better, [*rates, tried("damage"), tried("flow")], plain)
    best = better(best, tried(rate, "damage", "flow"))
    if best is plain:
        return plain
    return _smoothest(of_nodes, best.law)[1]


class Laws:
    """Plain terms and what may be added to them, on the same rows: each column is made once."""

    rates = ("faster at the surface", "faster inside")

    def __init__(self, plain: Terms, rows: PassiveRows, data: TrainingSet) -> None:
        self._plain, self._data = plain, data
        values = term_columns(plain, data, rows.rows)
        self._rows = rows.released(values, PENALTIES[1] * plain.roughness())
        self._columns = {"": values}

    @cached_property
    def covered(self) -> bool:
        """True if a row lies between every two nodes of a curve."""
        depths_m = np.concatenate(self._data.depths_m)[self._rows.rows]
        pieces = self._plain.nodes - 1
        at = np.floor(self._plain.shares(depths_m) * pieces)
        return len(np.unique(np.minimum(at, pieces - 1))) >= pieces  # the deepest is in the last

    def choices(
        self, law: tuple[str, ...], penalties: Sequence[float] = PENALTIES
    ) -> list[PassiveChoice]:
        """Plain terms with those of a law, in the order of `Terms`: rates, damage, flow."""
        terms = reduce(self._added, law, self._plain)
        for name in law:
            if name not in self._columns:
                self._columns[name] = self._values(self._added(self._plain, name))
        values = np.concatenate([self._columns[name] for name in ("", *law)], axis=1)
        parts = self._rows.parts(values)
        return [
            PassiveChoice(law, terms, penalty, (), parts, self._rows).judged(values)
            for penalty in penalties
        ]

    def _added(self, terms: Terms, name: str) -> Terms:
        if name in self.rates:
            return with_rates(terms, self._data, RATE_RATIOS[self.rates.index(name)])
        return with_damage(terms) if name == "damage" else with_flow(terms, self._data)

    def _values(self, terms: Terms) -> Samples:
        dt_s = self._data.dt_s
        return self._data.along_motions(
            self._rows.rows, lambda motion, at: added_columns(terms, motion, dt_s, at)
        )


def _smoothest(of_nodes: Callable[[int], Laws], law: tuple[str, ...]) -> tuple[Laws, PassiveChoice]:
    """The choice of lowest error, and its laws: those that bend more have to earn it.

    More nodes are tried as long as the ones before took a tenth off the error, and if rows lie
    between every two of them: elsewhere nothing holds them.
    """
    best: PassiveChoice | None = None
    for nodes in NODES:
        if nodes > _UNCOVERED and not of_nodes(nodes).covered:
            break
        before, its = best, min(of_nodes(nodes).choices(law), key=_smooth_error_n)
        if best is None or _smooth_error_n(its) < _smooth_error_n(best):
            best = its
        if before and its.error_n > BETTER * before.error_n:
            break
    assert best is not None
    return of_nodes(best.terms.nodes), best


def _smooth_error_n(choice: PassiveChoice) -> float:
    """Error that ranks curves: a rougher penalty and more nodes weigh."""
    rougher = PENALTIES.index(choice.penalty)
    return choice.error_n * _ROUGHER**rougher * _FINER[NODES.index(choice.terms.nodes)]


def better(best: PassiveChoice, other: PassiveChoice) -> PassiveChoice:
    """The richer law if it has less error in all, and no more in any family of folds."""
    pairs = zip(other.errors_n, best.errors_n, strict=True)
    negligible_n = NEGLIGIBLE * best.rows.peak_n
    gains = hypot(other.error_n, negligible_n) < BETTER * hypot(best.error_n, negligible_n)
    return other if gains and all(its <= NO_WORSE * bests for its, bests in pairs) else best


def _penalised(parts: Sequence[Normal], penalty: float, terms: Terms) -> Normal:
    return reduce(add, parts).penalised(penalty * terms.roughness())
