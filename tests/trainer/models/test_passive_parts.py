"""Parts of the passive fit by themselves: few terms, errors at the surface, growth, recovery."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.small import DEPTH_M, DT_S, passive_force_n, passive_model, press

from springpot import Recording
from springpot.codegen.model.passive import Damage, Flow, Hammerstein
from springpot.codegen.model.places import Places
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive import growth
from springpot.trainer.models.passive.growth import Growth
from springpot.trainer.models.passive.nonnegative import normal_equations, sparse_solve
from springpot.trainer.models.passive.passive_rows import select_rows
from springpot.trainer.models.passive.passive_terms import (
    add_damage,
    add_depth_rates,
    add_flow,
    build_model,
    plain_terms,
)
from springpot.trainer.models.passive.recovery import _SurfaceMotion
from springpot.trainer.models.passive.term_values import build_design_matrix
from springpot.trainer.models.training_set import build_training_set


@pytest.mark.parametrize("ratio", [16.0, 1.0 / 16.0])
def test_terms_times_weights_are_the_force_of_the_model_that_they_make(ratio: float) -> None:
    """Compare terms of all kinds at a third of the samples with the model: two pieces of C."""
    depth_m = np.concatenate([press(1.0, DEPTH_M, 2), 0.6 * press(3.0, DEPTH_M, 2)])
    data = build_training_set([Recording("x", depth_m, depth_m, DT_S)], 0.0)
    plain = replace(plain_terms(data, 9), bias=(1.0, -1.0))
    terms = add_flow(add_damage(add_depth_rates(plain, data, ratio)), data)
    weights = np.random.default_rng(0).exponential(1.0, terms.count)
    rows = np.arange(1, len(depth_m), 3)
    force_n = build_design_matrix(terms, data, rows) @ weights
    model = build_model(terms, weights)
    wanted_n = passive_force_n(model, data.motions[0].depth_m, DT_S, surface=False)[rows]
    np.testing.assert_allclose(force_n, wanted_n, rtol=1e-9)


def test_what_few_terms_lose_does_not_add_up() -> None:
    """Twenty terms, each of which alone is worth a third of what may be lost."""
    rng = np.random.default_rng(1)
    columns = rng.normal(size=(4000, 20))
    normal = normal_equations(columns, columns @ np.full(20, 0.06) + rng.normal(size=4000))
    found = sparse_solve(normal, np.arange(20), 0.005)
    assert 10 < np.count_nonzero(found) < 20
    assert normal.rmse(found) <= 1.005 * normal.rmse(normal.solve())


@pytest.mark.parametrize("surface", [True, False])
def test_a_pull_is_no_error_at_a_surface(surface: bool) -> None:
    depth_m = press(1.0)
    springs = [Recording(f"{k}", depth_m, k * depth_m, DT_S) for k in (100.0, 200.0, 300.0)]
    rows = replace(select_rows(build_training_set(springs, 0.0), FitOptions()), surface=surface)
    pulled_n = np.full((len(rows.rows), len(rows.held_out)), -1.0)
    families_n, folds_n = rows.errors_n(pulled_n)
    given_n = 0.0 if surface else -1.0
    owner = rows.in_fold[np.argsort(rows.order)]
    missed_n = [np.sqrt(np.mean((given_n - rows.force_n[its]) ** 2)) for its in owner.T]
    np.testing.assert_allclose(folds_n, missed_n)
    assert families_n == pytest.approx([np.exp(np.mean(np.log(missed_n)))])


@pytest.mark.parametrize(
    ("errors_n", "weights"),
    [(3 * [[1.0, 0.5, 0.6, 0.5]], [0.0, 1.0, (5 / 6) ** 4, 1.0]),
     ([[1.0, 0.5, 1.0, 1.0], [1.0, 1.0, 0.8, 1.0], 4 * [1.0]],
      [0.0, 2.0 ** (4 / 3), 0.8 ** (-4 / 3), 1.0]),
     (3 * [[0.95, 1.0, 1.0, 1.0]], [0.95**-4, 1.0, 1.0, 1.0]),
     ([[1.0, 0.5, 0.5, 0.5], [], 4 * [0.5]], None)],
)  # fmt: skip
def test_laws_of_growth_weigh_by_what_they_foretell(
    errors_n: list[list[float]], weights: list[float] | None, monkeypatch: Any
) -> None:
    tried = dict(zip((0.85, 0.9, 0.95), errors_n, strict=True))
    monkeypatch.setattr(growth, "_extrapolation_rmse_n", lambda _terms, share, *_: tried[share])
    monkeypatch.setattr(growth, "keep_used_terms", lambda terms, _weights: terms)
    rows: Any = SimpleNamespace(rows=None, peak_n=0.0)
    data: Any = SimpleNamespace(map_motions=lambda *_: None)
    none: Any = None
    found = growth.estimate_growth(none, none, 1e-3, rows, data)
    assert (found is None) is (weights is None)
    if found is not None and weights is not None:
        np.testing.assert_allclose(found.weights, np.array(weights) / np.sum(weights))
        assert found.foretold is (errors_n[0][0] == 1.0)


ONLY = {
    power: Growth(weights, True)
    for power, weights in zip(growth.SLOPE_POWERS, np.eye(4)[1:], strict=True)
}
SLOPES = {
    0.2: lambda u: (0.5 + u) ** 5,
    0.0: lambda u: np.exp(3.0 * u),
    -1 / 3: lambda u: (2.2 - u) ** -3,
}


def rich(nodes: int, slope: Any) -> Hammerstein:
    """A model with all that a passive one has; every curve has these slopes, as times its own."""
    slopes_n = slope(np.linspace(0.0, 1.0, nodes))
    return Hammerstein(
        origin_m=0.0, span_m=DEPTH_M, elastic_n=slopes_n, tau_s=np.array([0.01, 0.2, 2.0]),
        branch_n=np.array([[0.1], [0.2], [0.3]]) * slopes_n, radius_m=np.array([0.1 * DEPTH_M]),
        stop_n=0.3 * slopes_n[None], bias_n=0.0, n_by_depth=1, rate_ratio=16.0,
        flow=Flow(np.array([30.0, 3.0]), np.array([5, 3]), np.array([1, 4]), np.array([0.2, 0.5])),
        damage=Damage(np.array([0.5, 0.0]), np.array([3, 1]), np.array([[0.4], [0.2]]) * slopes_n),
    )  # fmt: skip


@pytest.mark.parametrize("nodes", [9, 13, 25])
@pytest.mark.parametrize("power", SLOPES)
def test_curves_go_on_as_they_rise_and_no_force_within_changes(power: float, nodes: int) -> None:
    model = rich(nodes, SLOPES[power])
    further = growth.extrapolate_curves(model, ONLY[power])
    u = np.linspace(0.0, 1.25, further.nodes)
    np.testing.assert_allclose(further.branch_n[1], 1.25 * 0.2 * SLOPES[power](u), rtol=1e-9)
    twice_m = np.concatenate([press(1.0), 0.7 * press(2.0)])
    inside_n, its_n = (passive_force_n(its, twice_m, DT_S, True) for its in (model, further))
    np.testing.assert_allclose(its_n, inside_n, atol=1e-9 * inside_n.max())


def test_what_softens_keeps_its_slope_and_no_slope_grows_beyond_all_bounds() -> None:
    softens = growth.extrapolate_curves(rich(9, lambda u: 2.0 - u), ONLY[0.2])
    np.testing.assert_array_equal(softens.elastic_n[8:], softens.elastic_n[8])
    pole = growth.extrapolate_curves(rich(9, lambda u: (1.05 - u) ** -3.0), ONLY[-1 / 3])
    assert pole.elastic_n[-1] == pytest.approx(2.25 * pole.elastic_n[8])


@pytest.mark.parametrize("foretold", [True, False])
def test_a_curve_that_little_force_came_from_grows_no_more_than_all_together(
    foretold: bool,
) -> None:
    """A slow branch that rises steeply where a spring has stopped to."""
    u = np.linspace(0.0, 1.0, 9)
    slow, spring_n = np.exp(12.0 * (u - 1.0)), 4.0 - 2.0 * u
    model = replace(
        rich(9, lambda u: 0.0 * u), elastic_n=spring_n, branch_n=np.stack([slow, 0 * u, 0 * u])
    )
    grown = growth.extrapolate_curves(model, Growth(np.eye(4)[3], foretold))
    total_n = grown.elastic_n + grown.branch_n[0]
    last_n = total_n[8]
    straight_n = last_n + (last_n - total_n[5:8].mean()) / 0.25 * (np.arange(9, 11) / 8.0 - 1.0)
    assert grown.branch_n[0, -1] < 2.0 * grown.branch_n[0, 8]
    assert np.all(
        total_n[9:] <= (2.25 * last_n if foretold else 1.5 * np.maximum(straight_n, last_n))
    )


def test_each_place_of_a_map_goes_on_as_its_own_curves_rise() -> None:
    model, soft = rich(9, SLOPES[0.2]), rich(9, lambda u: 1.0 + 0.1 * u)
    amounts = np.array([[[1.0, 0.0], [0.5, 0.5]], [[0.0, 1.0], [0.2, 0.1]]])
    places = Places(np.zeros(2), np.ones(2), amounts, np.stack([model.slopes_n, soft.slopes_n]))
    found = growth.extrapolate_curves(
        replace(model.with_slopes(places.most_n), places=places), ONLY[0.2]
    )
    found.require_valid()
    assert found.places is not None
    for own, slopes_n in zip((model, soft), found.places.slopes_n, strict=True):
        np.testing.assert_array_equal(slopes_n, growth.extrapolate_curves(own, ONLY[0.2]).slopes_n)


def test_the_tool_is_away_where_a_surface_that_recovers_gives_no_force() -> None:
    model = passive_model().hammerstein
    slow = replace(model, recovers=True, branch_n=9.0 * model.branch_n)
    depth_m = press(4.0, DEPTH_M, 3)
    force_n = passive_force_n(slow, depth_m, DT_S, surface=True)
    data = build_training_set([Recording("x", depth_m, force_n, DT_S)], 0.0)
    rows = select_rows(data, FitOptions())
    away = _SurfaceMotion(slow, rows, data).detached
    assert 0.02 < np.mean(away) < 0.5 and np.abs(rows.force_n[away]).max() < 1e-9 * rows.peak_n
    assert not _SurfaceMotion(replace(slow, recovers=False), rows, data).detached.any()
