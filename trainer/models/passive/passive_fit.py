"""The passive part of a model, chosen by cross-validated error: curves, rates, flow and damage."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial, reduce
from math import hypot, inf, sqrt
from operator import add

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.passive import Hammerstein
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import geometric_mean
from springpot.trainer.models.passive.growth import continued, growth_weights
from springpot.trainer.models.passive.nonnegative import Normal, sparse_solve
from springpot.trainer.models.passive.passive_force import with_memory
from springpot.trainer.models.passive.passive_rows import (
    NEGLIGIBLE,
    PassiveRows,
    let_go,
    passive_rows,
)
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
from springpot.trainer.models.passive.term_values import added_hats, flowing, plain_hats
from springpot.trainer.models.training_set import TrainingSet

NODES = (9, 13, 25)  # of each curve; the last where a layer is pressed flat within a few hundredths
PENALTIES = (1e-3, 1e-4, 1e-5)  # on the roughness of curves; forces in shares of the peak
_ROUGHER = 1.01  # times less error is what a penalty ten times lower has to bring,
_UNCOVERED = 13  # nodes, between which rows may be missing
_FORCE = "force"  # beside the names of laws
_FINER = (1.0, 1.01, 1.1)  # and more nodes: 25 cost flash
BETTER, NO_WORSE = 0.9, 1.02  # times the error, in all and in each family, of a richer law
RATE_RATIOS = (16.0, 1.0 / 16.0)  # relaxing faster at the surface, or deep inside


@dataclass(frozen=True, eq=False)
class PassiveChoice:
    """Terms and a penalty on their roughness; law: the names of the terms that a plain law lacks.

    errors_n: RMSE over held-out folds, N, of each family; folds_n: of each fold. normal:
    equations, in shares of the peak, of all rows for 0, then without each fold of `rows.held`.
    """

    law: tuple[str, ...]
    terms: Terms
    penalty: float
    errors_n: Sequence[float]
    normal: Callable[[int], Normal]
    rows: PassiveRows
    folds_n: Samples = field(default_factory=lambda: np.empty(0))

    @property
    def error_n(self) -> float:
        """Geometric mean over the families of folds, N."""
        return geometric_mean(list(self.errors_n)) if self.errors_n else 0.0

    @cached_property
    def _penalty(self) -> Samples:
        return self.penalty * self.terms.roughness()

    @cached_property
    def weights_of_all(self) -> Samples:
        """Fitted to all rows, (terms,), N."""
        return self.rows.peak_n * self.normal(0).penalised(self._penalty).solve()

    @cached_property
    def _sparse_weights(self) -> Samples:
        """Fitted to all rows with as few branches, stops and curves as serve, (terms,), N."""
        normal = self.normal(0).penalised(self._penalty)
        return self.rows.peak_n * sparse_solve(normal, self.terms.blocks, SPARSE_LOSS)

    def recovering(self, data: TrainingSet) -> Hammerstein:
        """Build the model to the trained depth; its surface recovers if the object's does."""
        model = to_model(self.terms, self._sparse_weights)
        return recovering(model, self.terms, self.penalty, self.rows, data)

    def growing(self, model: Hammerstein, data: TrainingSet) -> Hammerstein:
        """The model with slopes that grow beyond the trained depth, if the object's do."""
        weights = growth_weights(self.terms, self._sparse_weights, self.penalty, self.rows, data)
        return model if weights is None else continued(model, weights)

    def model(self, data: TrainingSet) -> Hammerstein:
        """Build the model, with its memory."""
        return with_memory(self.growing(self.recovering(data), data), data)

    @cached_property
    def weights_without(self) -> Samples:
        """Fitted without each fold of `rows.held`, (terms, folds), N; NaN: that leaves no rows."""
        none = np.full(self.terms.count, np.nan)
        normals = [self.normal(1 + k) for k in range(len(self.rows.held))]
        found = [
            each.penalised(self._penalty).solve(near=self.weights_of_all) if each.rows else none
            for each in normals
        ]
        return self.rows.peak_n * np.stack(found, axis=1)


def fit_passive(data: TrainingSet, options: FitOptions) -> Hammerstein:
    """Fit the passive part beside another, whatever share of the rows the other is fitted on."""
    return timed_passive(data, replace(options, fraction=None))[0]


def timed_passive(
    data: TrainingSet, options: FitOptions
) -> tuple[Hammerstein, PassiveChoice, float]:
    """Return the model of `passive_choice`, that choice, and the seconds of both; made once."""
    choice, chosen_s = passive_choice(data, options)
    key = ("passive model", data.continues, options.fraction, options.seed, options.poles)
    model, model_s = data.once(key, lambda: choice.model(data))
    return model, choice, chosen_s + model_s


def passive_choice(data: TrainingSet, options: FitOptions) -> tuple[PassiveChoice, float]:
    """The terms of lowest cross-validated error, by steps, and the seconds that it took.

    Done once for the options that decide it.
    """

    def found() -> PassiveChoice:
        chosen = _chosen(data, options)
        normals = [chosen.normal(k) for k in range(1 + len(chosen.rows.held))]
        laws_of.cache_clear()  # they hold all columns
        return replace(chosen, normal=normals.__getitem__)

    key = ("passive", data.continues, options.fraction, options.seed, options.poles)
    return data.once(key, found)


def _chosen(data: TrainingSet, options: FitOptions) -> PassiveChoice:
    """First curves and a penalty, then what the object does besides, then the curves once more.

    By steps and not the lowest of all: with few recordings hundredths are chance, and a simpler law
    extrapolates better.
    """
    of_nodes = partial(laws_of, data, options)
    laws, plain = _smoothest(of_nodes, ())
    if not plain.rows.varied or options.poles < DEPTH_POLES:
        return plain

    def tried(*names: str) -> PassiveChoice:
        return laws.choices(names, (plain.penalty,), needed_n(plain))[0]

    rates = [tried(name) for name in laws.rates]
    (rate,) = min(rates, key=lambda choice: choice.error_n).law
    best = reduce(better, [*rates, tried("damage"), tried("flow")], plain)
    best = better(best, tried(rate, "damage", "flow"))
    return plain if best is plain else _smoothest(of_nodes, best.law)[1]


@lru_cache(maxsize=3)
def laws_of(data: TrainingSet, options: FitOptions, nodes: int) -> "Laws":
    """Laws of curves with so many nodes; the last ones are kept."""
    key = ("rows", options.fraction, options.seed)
    rows, _ = data.once(key, lambda: passive_rows(data, options))
    return Laws(plain_terms(data, nodes, options.poles), rows, data)


class Laws:
    """Plain terms and what may be added to them, on the same rows: each column is made once.

    So are the products of any two columns, summed over rows and without each fold.
    """

    rates = ("faster at the surface", "faster inside")

    def __init__(self, plain: Terms, rows: PassiveRows, data: TrainingSet) -> None:
        self._plain, self._data = plain, data
        values = data.along_motions(rows.rows, partial(plain_hats, plain, data.dt_s))
        values = np.hstack([values, np.tile([1.0, -1.0], (len(values), int(plain.bias)))])
        if rows.surface:
            sums, form = self._summed("", np.eye(len(values.T))), PENALTIES[1] * plain.roughness()
            rows = replace(rows, let_go=let_go(values, sums, rows.force_n, rows.peak_n, form))
        force = np.column_stack([rows.force_n / rows.peak_n, np.ones(len(values))])
        self._rows = rows
        self._columns = {"": values[rows.order], _FORCE: force[rows.order]}
        self._products: dict[tuple[str, str], Samples] = {}

    @cached_property
    def covered(self) -> bool:
        """True if a row lies between every two nodes of a curve."""
        depths_m = np.concatenate(self._data.depths_m)[self._rows.rows]
        pieces = self._plain.nodes - 1
        at = np.floor(self._plain.shares(depths_m) * pieces)
        return len(np.unique(np.minimum(at, pieces - 1))) >= pieces  # the deepest is in the last

    def choices(
        self, law: tuple[str, ...], penalties: Sequence[float] = PENALTIES, most_n: float = inf
    ) -> list[PassiveChoice]:
        """Plain terms with those of a law, in the order of `Terms`: rates, damage, flow.

        Where even a fit to all rows errs by more than most_n, that is its error: without folds.
        """
        terms = reduce(self._added, law, self._plain)
        for name in law:
            if name not in self._columns:
                self._columns[name] = self._values(name)[self._rows.order]
        normal = partial(self._normal, ("", *law, _FORCE))
        found = [PassiveChoice(law, terms, each, (), normal, self._rows) for each in penalties]
        return [self._judged(its, most_n) for its in found]

    def _judged(self, choice: PassiveChoice, most_n: float) -> PassiveChoice:
        """The same with its errors, as `choices` says."""
        names = ("", *choice.law)
        sums = [self._summed(name, np.eye(self._columns[name].shape[1])) for name in names]
        cuts = np.cumsum([its.shape[1] for its in sums])[:-1]

        def judged(weights: Samples) -> PassiveChoice:
            parts = zip(names, sums, np.split(weights, cuts), strict=True)
            force_n = reduce(add, (self._columns[name] @ (its @ part) for name, its, part in parts))
            errors_n, folds_n = self._rows.errors_n(force_n)
            return replace(choice, errors_n=errors_n, folds_n=folds_n)

        # A fit without a fold errs there by as much as one with it, or more.
        if most_n < inf and (its := judged(choice.weights_of_all[:, None])).error_n > most_n:
            return its
        return judged(choice.weights_without)

    def _normal(self, names: Sequence[str], shown: int) -> Normal:
        """Normal equations of the rows that are shown; the force, and 1, is the last of names."""
        its = np.block([[self._products_of(a, b)[shown] for b in names] for a in names])
        return Normal(its[:-2, :-2], its[:-2, -2], float(its[-2, -2]), round(its[-1, -1]))

    def _products_of(self, one: str, other: str) -> Samples:
        """Products of terms, summed over all rows and without each fold: (1 + folds, k, l)."""
        if one > other:
            return self._products_of(other, one).swapaxes(1, 2)
        if (one, other) not in self._products:
            of_hats = self._rows.products(self._columns[one], self._columns[other])
            summed = self._summed(other, of_hats).swapaxes(1, 2)
            self._products[one, other] = self._summed(one, summed).swapaxes(1, 2)
        return self._products[one, other]

    def _summed(self, name: str, hats: Samples) -> Samples:
        """Terms in the place of their hats, along the last axis; what is no curve stays."""
        if name in ("flow", _FORCE):
            return hats
        curves = hats.shape[-1] // self._plain.nodes * self._plain.nodes
        of_curves, bias = np.split(hats, [curves], axis=-1)
        return np.concatenate([self._plain.with_exponentials(of_curves), bias], axis=-1)

    def _added(self, terms: Terms, name: str) -> Terms:
        if name in self.rates:
            return with_rates(terms, self._data, RATE_RATIOS[self.rates.index(name)])
        return with_damage(terms) if name == "damage" else with_flow(terms, self._data)

    def _values(self, name: str) -> Samples:
        """Columns that a law adds; those of flow, which takes longest, for any nodes once."""
        data, rows, terms = self._data, self._rows.rows, self._added(self._plain, name)
        if name != "flow":
            return data.along_motions(rows, partial(added_hats, terms, data.dt_s))
        every = (data.motions, data.dt_s, data.motion_rows(rows))
        key = ("flow", data.continues, rows.tobytes())
        return data.once(key, lambda: data.in_order(rows, flowing(terms, *every)))[0]


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


def needed_n(best: PassiveChoice) -> float:
    """Error that a richer law has to have to be better, N."""
    negligible_n = NEGLIGIBLE * best.rows.peak_n
    error_n = BETTER * hypot(best.error_n, negligible_n)
    return sqrt(max(error_n**2 - negligible_n**2, 0.0))


def better(best: PassiveChoice, other: PassiveChoice) -> PassiveChoice:
    """The richer law if it has less error in all, and no more in any family of folds."""
    pairs = zip(other.errors_n, best.errors_n, strict=True)
    gains = other.error_n < needed_n(best)
    return other if gains and all(its <= NO_WORSE * bests for its, bests in pairs) else best
