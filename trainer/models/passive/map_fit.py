"""The map of an object that was pressed at several places, from recordings of its sites."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.model.passive import Hammerstein
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive.map_problem import Grid, MapProblem, build_grid
from springpot.trainer.models.passive.nonnegative import Normal, normal_equations
from springpot.trainer.models.passive.passive_fit import NODES, select_passive
from springpot.trainer.models.passive.passive_rows import find_separated_rows
from springpot.trainer.models.passive.passive_terms import Terms, plain_terms
from springpot.trainer.models.passive.term_values import build_design_matrix
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording, group_by_site

MIN_SITES = 4  # sites of a map
_FULL_TIME_FRACTION = 0.5  # of the longest site's time: what is shorter shows amounts, not the law
_MAX_LAW_SITES = 9  # their presses choose the law
_MAX_SITE_ROWS = 4000  # of a site
_INITIAL_PENALTY = 1e-4  # penalty on the roughness of curves before one is chosen


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
    sites = group_by_site(data.recordings)
    if len(sites) < MIN_SITES or data.contact != "surface":
        raise DataError(
            f"{data.recordings[0].name}: a map needs presses from the surface at {MIN_SITES} "
            f"places, these are of {len(sites)}: record more places, or leave the places out"
        )
    site_sets = [
        replace(
            data,
            recordings=tuple(data.recordings[k] for k in numbers),
            depths_m=tuple(data.depths_m[k] for k in numbers),
            warnings=(),
        )
        for numbers in sites.values()
    ]
    longest_s = max(part.rows_total for part in site_sets)
    full = [
        k for k, part in enumerate(site_sets) if part.rows_total >= _FULL_TIME_FRACTION * longest_s
    ]
    grid = build_grid(list(sites))
    law_sites = full[:: -(-len(full) // _MAX_LAW_SITES)]
    initial_problem = _build_problem(
        site_sets, plain_terms(data, NODES[0]), _INITIAL_PENALTY, grid, full
    )
    rescaled = _rescale_sites(site_sets, law_sites, initial_problem.amounts)
    choice = select_passive(rescaled, options)[0]
    problem = _build_problem(site_sets, choice.terms, choice.penalty, grid, full).sparse()
    count, error_n = problem.chosen(options.seed)
    model = problem.model(*problem.fitted(range(len(sites)), count))
    model = replace(model, recovers=choice.fit_recovery(rescaled).recovers)
    model = choice.extrapolate(model, rescaled)
    return MapFit(model, sum(site.rows for site in problem.sites), error_n, choice.law, len(sites))


def _rescale_sites(
    site_sets: Sequence[TrainingSet], law_sites: Sequence[int], amounts: Samples
) -> TrainingSet:
    """Return the presses of the chosen sites, scaled as if all were equally stiff."""
    mean_amount = float(np.mean(amounts[list(law_sites)]))
    recordings: list[Recording] = []
    depths_m: list[Samples] = []
    for k in law_sites:
        factor = mean_amount / amounts[k]
        site_recordings = site_sets[k].recordings
        recordings += [
            replace(recording, force_n=factor * recording.force_n) for recording in site_recordings
        ]
        depths_m += site_sets[k].depths_m
    template = site_sets[0]
    return replace(template, recordings=tuple(recordings), depths_m=tuple(depths_m))


def _build_problem(
    site_sets: Sequence[TrainingSet], terms: Terms, penalty: float, grid: Grid, full: Sequence[int]
) -> MapProblem:
    normals = [_site_normal_equations(part, terms, penalty) for part in site_sets]
    return MapProblem(grid, terms, penalty, normals, full)


def _site_normal_equations(data: TrainingSet, terms: Terms, penalty: float) -> Normal:
    """Return the normal equations of a site's rows, in N, without those that have let go."""
    rows = data.even_rows(_MAX_SITE_ROWS)
    force_n, values = data.force_n(rows), build_design_matrix(terms, data, rows)
    peak_n = max(float(np.abs(force_n).max()), 1e-12)
    kept = ~find_separated_rows(
        values, np.eye(terms.count), force_n, peak_n, penalty * terms.roughness()
    )
    normal = normal_equations(values[kept], force_n[kept] / peak_n)
    return Normal(normal.matrix, peak_n * normal.vector, peak_n**2 * normal.square, normal.rows)
