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
from springpot.trainer.models.passive.growth import estimate_growth, extrapolate_curves
from springpot.trainer.models.passive.nonnegative import Normal, sparse_solve
from springpot.trainer.models.passive.passive_force import store_memory
from springpot.trainer.models.passive.passive_rows import (
    IMPERCEPTIBLE_FRACTION,
    PassiveRows,
    find_separated_rows,
    select_rows,
)
from springpot.trainer.models.passive.passive_terms import (
    DEPTH_POLES,
    Terms,
    add_damage,
    add_depth_rates,
    add_flow,
    build_model,
    plain_terms,
)
from springpot.trainer.models.passive.recovery import SPARSE_LOSS, fit_recovery
from springpot.trainer.models.passive.term_values import (
    evaluate_added_hats,
    evaluate_plain_hats,
    simulate_flow,
)
from springpot.trainer.models.training_set import TrainingSet

NODES = (9, 13, 25)  # of each curve; the last where a layer is pressed flat within a few hundredths
PENALTIES = (1e-3, 1e-4, 1e-5)  # on the roughness of curves; forces in shares of the peak
_PENALTY_COST = 1.01  # times less error is what a penalty ten times lower has to bring,
_MAX_UNCOVERED_NODES = 13  # nodes, between which rows may be missing
_TARGET = "force"  # beside the names of laws
_NODE_COSTS = (1.0, 1.01, 1.1)  # and more nodes: 25 cost flash
MAX_ERROR_RATIO, MAX_FAMILY_RATIO = (
    0.9,
    1.02,
)  # times the error, in all and in each family, of a richer law
RATE_RATIOS = (16.0, 1.0 / 16.0)  # relaxing faster at the surface, or deep inside


@dataclass(frozen=True, eq=False)
class PassiveChoice:
    """Terms and a penalty on their roughness; law: the names of the terms that a plain law lacks.

    errors_n: RMSE over held-out folds, N, of each family; folds_n: of each fold. normal:
    equations, in shares of the peak, of all rows for 0, then without each fold of `rows.held_out`.
    near: weights of another penalty, from which the search begins.
    """

    law: tuple[str, ...]
    terms: Terms
    penalty: float
    errors_n: Sequence[float]
    normal: Callable[[int], Normal]
    rows: PassiveRows
    folds_n: Samples = field(default_factory=lambda: np.empty(0))
    near: Samples | None = None

    @property
    def error_n(self) -> float:
        """Geometric mean over the families of folds, N."""
        return geometric_mean(list(self.errors_n)) if self.errors_n else 0.0

    @cached_property
    def _penalty(self) -> Samples:
        return self.penalty * self.terms.roughness()

    @cached_property
    def full_weights(self) -> Samples:
        """Fitted to all rows, (terms,), N."""
        return self.rows.peak_n * self.normal(0).penalised(self._penalty).solve(near=self.near)

    @cached_property
    def _sparse_weights(self) -> Samples:
        """Fitted to all rows with as few branches, stops and curves as serve, (terms,), N."""
        normal = self.normal(0).penalised(self._penalty)
        blocks, near = self.terms.blocks, self.full_weights
        return self.rows.peak_n * sparse_solve(normal, blocks, SPARSE_LOSS, near)

    def fit_recovery(self, data: TrainingSet) -> Hammerstein:
        """Build the model to the trained depth; its surface recovers if the object's does."""
        model = build_model(self.terms, self._sparse_weights)
        return fit_recovery(model, self.terms, self.penalty, self.rows, data)

    def extrapolate(self, model: Hammerstein, data: TrainingSet) -> Hammerstein:
        """Let slopes grow beyond the trained depth as those within it do."""
        growth = estimate_growth(self.terms, self._sparse_weights, self.penalty, self.rows, data)
        return model if growth is None else extrapolate_curves(model, growth)

    def model(self, data: TrainingSet) -> Hammerstein:
        """Build the model, with its memory."""
        return store_memory(self.extrapolate(self.fit_recovery(data), data), data)

    @cached_property
    def fold_weights(self) -> Samples:
        """Return the weights of fits without each fold of `rows.held_out`, (terms, folds), N.

        Cross-validation predicts a fold by weights that have not seen it. NaN where that leaves no
        rows to fit.
        """
        none = np.full(self.terms.count, np.nan)
        normals = [self.normal(1 + k) for k in range(len(self.rows.held_out))]
        solutions = [
            normal.penalised(self._penalty).solve(near=self.full_weights) if normal.rows else none
            for normal in normals
        ]
        return self.rows.peak_n * np.stack(solutions, axis=1)


def fit_passive(data: TrainingSet, options: FitOptions) -> Hammerstein:
    """Fit the passive part beside another, whatever share of the rows the other is fitted on."""
    return fit_passive_timed(data, replace(options, fraction=None))[0]


def fit_passive_timed(
    data: TrainingSet, options: FitOptions
) -> tuple[Hammerstein, PassiveChoice, float]:
    """Return the model of `select_passive`, that choice, and the seconds of both; made once."""
    choice, chosen_s = select_passive(data, options)
    key = ("passive model", options.fraction, options.seed, options.poles)
    model, model_s = data.cached(key, lambda: choice.model(data))
    return model, choice, chosen_s + model_s


def select_passive(data: TrainingSet, options: FitOptions) -> tuple[PassiveChoice, float]:
    """Choose the terms of the passive model by cross-validation; return the seconds too.

    Done once for the options that decide it.
    """

    def select() -> PassiveChoice:
        chosen = _select_law(data, options)
        normals = [chosen.normal(k) for k in range(1 + len(chosen.rows.held_out))]
        build_laws.cache_clear()  # they hold all columns
        return replace(chosen, normal=normals.__getitem__)

    key = ("passive", options.fraction, options.seed, options.poles)
    return data.cached(key, select)


def _select_law(data: TrainingSet, options: FitOptions) -> PassiveChoice:
    """Choose curves and a penalty first, then what the object does besides, then curves again.

    Besides: damage, flow, rates by depth. By steps and not the lowest of all: with few recordings
    hundredths are chance, and a simpler law extrapolates better.
    """
    laws_with_nodes = partial(build_laws, data, options)
    laws, plain = _select_curves(laws_with_nodes, ())
    if not plain.rows.varied or options.poles < DEPTH_POLES:
        return plain

    def fit_law(*names: str) -> PassiveChoice:
        return laws.fit_law(names, (plain.penalty,), required_error_n(plain))[0]

    rates = [fit_law(name) for name in laws.rates]
    (rate,) = min(rates, key=lambda choice: choice.error_n).law
    best = reduce(select_richer, [*rates, fit_law("damage"), fit_law("flow")], plain)
    best = select_richer(best, fit_law(rate, "damage", "flow"))
    return plain if best is plain else _select_curves(laws_with_nodes, best.law)[1]


@lru_cache(maxsize=3)
def build_laws(data: TrainingSet, options: FitOptions, nodes: int) -> "Laws":
    """Laws of curves with so many nodes; the last ones are kept."""
    key = ("rows", options.fraction, options.seed)
    rows, _ = data.cached(key, lambda: select_rows(data, options))
    return Laws(plain_terms(data, nodes, options.poles), rows, data)


class Laws:
    """Plain terms and what may be added to them, on the same rows: each column is made once.

    So are the products of any two columns, summed over rows and without each fold.
    """

    rates = ("faster at the surface", "faster inside")

    def __init__(self, plain: Terms, rows: PassiveRows, data: TrainingSet) -> None:
        """Evaluate the plain terms at all rows once: every law of the search is built from them."""
        self._plain, self._data = plain, data
        values = data.map_motions(rows.rows, partial(evaluate_plain_hats, plain, data.dt_s))
        if plain.bias:
            values = np.hstack([values, np.tile(plain.bias, (len(values), 1))])
        if rows.surface:
            sums, form = self._to_terms("", np.eye(len(values.T))), PENALTIES[1] * plain.roughness()
            rows = replace(
                rows, separated=find_separated_rows(values, sums, rows.force_n, rows.peak_n, form)
            )
        force = np.column_stack([rows.force_n / rows.peak_n, np.ones(len(values))])
        self._rows = rows
        self._columns = {"": values[rows.order], _TARGET: force[rows.order]}
        self._products: dict[tuple[str, str], Samples] = {}

    @cached_property
    def covers_every_interval(self) -> bool:
        """True if a row lies between every two nodes of a curve."""
        depths_m = np.concatenate(self._data.depths_m)[self._rows.rows]
        n_intervals = self._plain.nodes - 1
        interval = np.floor(self._plain.normalised_depth(depths_m) * n_intervals)
        return (
            len(np.unique(np.minimum(interval, n_intervals - 1))) >= n_intervals
        )  # the deepest is in the last

    def fit_law(
        self, law: tuple[str, ...], penalties: Sequence[float] = PENALTIES, max_error_n: float = inf
    ) -> list[PassiveChoice]:
        """Fit the plain terms with those of a law: rates, damage, flow; cross-validate if worth it.

        Where even a fit to all rows errs by more than max_error_n, no fold is held out.
        """
        terms = reduce(self._add_terms, law, self._plain)
        for name in law:
            if name not in self._columns:
                self._columns[name] = self._compute_columns(name)[self._rows.order]
        normal = partial(self._normal_equations, ("", *law, _TARGET))
        choices, near = list[PassiveChoice](), None
        for penalty in penalties:
            choice = PassiveChoice(law, terms, penalty, (), normal, self._rows, near=near)
            choices.append(self._cross_validate(choice, max_error_n))
            near = choice.full_weights
        return choices

    def _cross_validate(self, choice: PassiveChoice, most_n: float) -> PassiveChoice:
        """Add the errors of held-out folds; see `fit_law`."""
        names = ("", *choice.law)
        sums = [self._to_terms(name, np.eye(self._columns[name].shape[1])) for name in names]
        cuts = np.cumsum([block.shape[1] for block in sums])[:-1]

        def evaluate(weights: Samples) -> PassiveChoice:
            parts = zip(names, sums, np.split(weights, cuts), strict=True)
            force_n = reduce(
                add, (self._columns[name] @ (to_terms @ part) for name, to_terms, part in parts)
            )
            errors_n, folds_n = self._rows.errors_n(force_n)
            return replace(choice, errors_n=errors_n, folds_n=folds_n)

        # A fit without a fold errs there by as much as one with it, or more.
        if most_n < inf and (shown := evaluate(choice.full_weights[:, None])).error_n > most_n:
            return shown
        return evaluate(choice.fold_weights)

    def _normal_equations(self, names: Sequence[str], shown: int) -> Normal:
        """Normal equations of the rows that are shown; the force, and 1, is the last of names."""
        gram = np.block([[self._gram_block(a, b)[shown] for b in names] for a in names])
        return Normal(gram[:-2, :-2], gram[:-2, -2], float(gram[-2, -2]), round(gram[-1, -1]))

    def _gram_block(self, one: str, other: str) -> Samples:
        """Return products of terms over all rows and without each fold, (1 + folds, k, l)."""
        if one > other:
            return self._gram_block(other, one).swapaxes(1, 2)
        if (one, other) not in self._products:
            hat_products = self._rows.gram_by_fold(self._columns[one], self._columns[other])
            summed = self._to_terms(other, hat_products).swapaxes(1, 2)
            self._products[one, other] = self._to_terms(one, summed).swapaxes(1, 2)
        return self._products[one, other]

    def _to_terms(self, name: str, hats: Samples) -> Samples:
        """Replace hats by terms, along the last axis; what is no curve stays."""
        if name in ("flow", _TARGET):
            return hats
        curves = hats.shape[-1] // self._plain.nodes * self._plain.nodes
        curve_hats, bias = np.split(hats, [curves], axis=-1)
        return np.concatenate([self._plain.append_exponentials(curve_hats), bias], axis=-1)

    def _add_terms(self, terms: Terms, name: str) -> Terms:
        if name in self.rates:
            return add_depth_rates(terms, self._data, RATE_RATIOS[self.rates.index(name)])
        return add_damage(terms) if name == "damage" else add_flow(terms, self._data)

    def _compute_columns(self, name: str) -> Samples:
        """Columns that a law adds; those of flow, which takes longest, for any nodes once."""
        data, rows, terms = self._data, self._rows.rows, self._add_terms(self._plain, name)
        if name != "flow":
            return data.map_motions(rows, partial(evaluate_added_hats, terms, data.dt_s))
        key, flow = ("flow", rows.tobytes()), partial(simulate_flow, terms, data.dt_s)
        return data.cached(key, lambda: data.map_motions(rows, flow))[0]


def _select_curves(
    laws_with_nodes: Callable[[int], Laws], law: tuple[str, ...]
) -> tuple[Laws, PassiveChoice]:
    """Choose the number of nodes and the penalty on bends, of lowest cross-validated error.

    More nodes are tried as long as the ones before took a tenth off the error, and if rows lie
    between every two of them: elsewhere nothing holds them.
    """
    best: PassiveChoice | None = None
    for nodes in NODES:
        if nodes > _MAX_UNCOVERED_NODES and not laws_with_nodes(nodes).covers_every_interval:
            break
        before, choice = best, min(laws_with_nodes(nodes).fit_law(law), key=_ranked_error_n)
        if best is None or _ranked_error_n(choice) < _ranked_error_n(best):
            best = choice
        if before and choice.error_n > MAX_ERROR_RATIO * before.error_n:
            break
    assert best is not None
    return laws_with_nodes(best.terms.nodes), best


def _ranked_error_n(choice: PassiveChoice) -> float:
    """Error that ranks curves: a rougher penalty and more nodes weigh."""
    rougher = PENALTIES.index(choice.penalty)
    return choice.error_n * _PENALTY_COST**rougher * _NODE_COSTS[NODES.index(choice.terms.nodes)]


def required_error_n(best: PassiveChoice) -> float:
    """Error that a richer law has to have to be better, N."""
    negligible_n = IMPERCEPTIBLE_FRACTION * best.rows.peak_n
    error_n = MAX_ERROR_RATIO * hypot(best.error_n, negligible_n)
    return sqrt(max(error_n**2 - negligible_n**2, 0.0))


def select_richer(best: PassiveChoice, other: PassiveChoice) -> PassiveChoice:
    """Return the richer law if it has less error in all, and no more in any family of folds."""
    pairs = zip(other.errors_n, best.errors_n, strict=True)
    gains = other.error_n < required_error_n(best)
    return (
        other
        if gains
        and all(error_n <= MAX_FAMILY_RATIO * best_error_n for error_n, best_error_n in pairs)
        else best
    )
