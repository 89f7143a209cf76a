"""Parts of the passive fit by themselves: few terms, errors at the surface, growth, recovery."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.small import DEPTH_M, DT_S, passive_force_n, passive_model, press

from springpot import Recording
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive import growth
from springpot.trainer.models.passive.nonnegative import normal_equations, sparse_solve
from springpot.trainer.models.passive.passive_rows import passive_rows
from springpot.trainer.models.passive.recovery import _Way
from springpot.trainer.models.training_set import training_set


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
    rows = replace(passive_rows(training_set(springs, 0.0), FitOptions()), surface=surface)
    pulled_n = np.full((len(rows.rows), len(rows.held)), -1.0)
    families_n, folds_n = rows.errors_n(pulled_n)
    given_n = 0.0 if surface else -1.0
    owner = rows.out[np.argsort(rows.order)]
    missed_n = [np.sqrt(np.mean((given_n - rows.force_n[its]) ** 2)) for its in owner.T]
    np.testing.assert_allclose(folds_n, missed_n)
    assert families_n == pytest.approx([np.exp(np.mean(np.log(missed_n)))])


@pytest.mark.parametrize(
    ("shallow_n", "deep_n", "grows"),
    [((1.0, 0.5, 0.8), (1.0, 1.1, 0.8), 2.0), ((1.0, 0.5, 0.8), (1.0, 0.6, 0.8), 1.0),
     ((1.0, 0.95, 0.95), (1.0, 0.95, 0.95), 0.0), ((1.0, 0.9, 0.8), (), 0.0)],
)  # fmt: skip
def test_growth_has_to_gain_in_all_and_lose_at_neither_share(
    shallow_n: tuple[float, ...], deep_n: tuple[float, ...], grows: float, monkeypatch: Any
) -> None:
    tried = dict(zip((0.7, 0.85), (list(shallow_n), list(deep_n)), strict=True))
    monkeypatch.setattr(growth, "_errors_n", lambda _terms, share, *_: tried[share])
    monkeypatch.setattr(growth, "reduced", lambda terms, _weights: terms)
    rows: Any = SimpleNamespace(rows=None, peak_n=1.0)
    data: Any = SimpleNamespace(along_motions=lambda *_: None)
    none: Any = None
    model = replace(passive_model().hammerstein, growth=0.0)
    assert growth.growing(model, none, none, 1e-3, rows, data).growth == grows


def test_the_tool_is_away_where_a_surface_that_recovers_gives_no_force() -> None:
    model = passive_model().hammerstein
    slow = replace(model, recovers=True, branch_n=9.0 * model.branch_n)
    depth_m = press(4.0, DEPTH_M, 3)
    force_n = passive_force_n(slow, depth_m, DT_S, surface=True)
    data = training_set([Recording("x", depth_m, force_n, DT_S)], 0.0)
    rows = passive_rows(data, FitOptions())
    away = _Way(slow, rows, data).away
    assert 0.02 < np.mean(away) < 0.5 and np.abs(rows.force_n[away]).max() < 1e-9 * rows.peak_n
    assert not _Way(replace(slow, recovers=False), rows, data).away.any()
