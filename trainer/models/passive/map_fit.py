"""The map of an object that was pressed at several places, from recordings of its sites."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.model.passive import Hammerstein
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive.map_problem import Grid, MapProblem, grid_of
from springpot.trainer.models.passive.nonnegative import Normal, normal_equations
from springpot.trainer.models.passive.passive_fit import NODES, passive_choice
from springpot.trainer.models.passive.passive_rows import let_go
from springpot.trainer.models.passive.passive_terms import Terms, plain_terms
from springpot.trainer.models.passive.term_values import term_columns
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording, sites_of

FEWEST_SITES = 4  # sites of a map
_FULL = 0.5  # of the longest site's time: what is shorter shows amounts, not the law
_LAW_SITES = 9  # their presses choose the law
_ROWS = 4000  # of a site
_SMOOTH = 1e-4  # penalty on the roughness of curves before one is chosen


@dataclass(frozen=True, eq=False)
class MapFit:
    """A map, its rows, its error at sites left out, N, and the law that all sites share."""

    model: Hammerstein
    rows: int
    error_n: float
    law: tuple[str, ...]
    sites: int


def fit_map(data: TrainingSet, options: FitOptions) -> MapFit:
    """Fit a map to recordings of at least four sites.

    Raises DataError if there are fewer, or if the object has no surface to come off from.
    """
    sites = sites_of(data.recordings)
    if len(sites) < FEWEST_SITES or data.contact != "surface":
        raise DataError(
            f"{data.recordings[0].name}: a map needs presses from the surface at {FEWEST_SITES} "
            f"places, these are of {len(sites)}: record more places, or leave the places out"
        )
    of_sites = [
        replace(
            data,
            recordings=tuple(data.recordings[k] for k in numbers),
            depths_m=tuple(data.depths_m[k] for k in numbers),
            warnings=(),
            _found={},
        )
        for numbers in sites.values()
    ]
    longest_s = max(part.rows_total for part in of_sites)
    full = [k for k, part in enumerate(of_sites) if part.rows_total >= _FULL * longest_s]
    grid = grid_of(list(sites))
    chosen = full[:: -(-len(full) // _LAW_SITES)]
    plain = _problem(of_sites, plain_terms(data, NODES[0]), _SMOOTH, grid, full)
    alike = _alike(of_sites, chosen, plain.amounts)
    choice = passive_choice(alike, options)[0]
    problem = _problem(of_sites, choice.terms, choice.penalty, grid, full).sparse()
    count, error_n = problem.chosen(options.seed)
    model = problem.model(*problem.fitted(range(len(sites)), count))
    model = replace(model, recovers=choice.recovering(alike).recovers)
    model = choice.growing(model, alike)
    return MapFit(model, sum(its.rows for its in problem.sites), error_n, choice.law, len(sites))


def _alike(of_sites: Sequence[TrainingSet], chosen: Sequence[int], amounts: Samples) -> TrainingSet:
    """Presses of the chosen sites, each force as if all sites had one amount: they show one law."""
    usual = float(np.mean(amounts[list(chosen)]))
    recordings: list[Recording] = []
    depths_m: list[Samples] = []
    for k in chosen:
        factor = usual / amounts[k]
        of_site = of_sites[k].recordings
        recordings += [replace(each, force_n=factor * each.force_n) for each in of_site]
        depths_m += of_sites[k].depths_m
    whole = of_sites[0]
    return replace(whole, recordings=tuple(recordings), depths_m=tuple(depths_m), _found={})


def _problem(
    of_sites: Sequence[TrainingSet], terms: Terms, penalty: float, grid: Grid, full: Sequence[int]
) -> MapProblem:
    found = [_rows(part, terms, penalty) for part in of_sites]
    return MapProblem(grid, terms, penalty, found, full)


def _rows(data: TrainingSet, terms: Terms, penalty: float) -> Normal:
    """Normal equations of a site, in N, without what has let go."""
    rows = data.even_rows(_ROWS)
    force_n, values = data.force_n(rows), term_columns(terms, data, rows)
    peak_n = max(float(np.abs(force_n).max()), 1e-12)
    kept = ~let_go(values, np.eye(terms.count), force_n, peak_n, penalty * terms.roughness())
    normal = normal_equations(values[kept], force_n[kept] / peak_n)
    return Normal(normal.matrix, peak_n * normal.vector, peak_n**2 * normal.square, normal.rows)
