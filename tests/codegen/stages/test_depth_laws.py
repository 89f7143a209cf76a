"""Branches whose rate depends on the depth, or that relax over hours: C, reference and trainer."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.small import DT_S, press, scene, small_model, training

from springpot.codegen.emit.files import emit_files
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.model.formulas import stretched
from springpot.codegen.model.model import Hammerstein, Model
from springpot.codegen.plan.plan import make_plan
from springpot.codegen.plan.units import state_bytes
from springpot.codegen.reference.run import run_reference
from springpot.host.native.replay import Replay
from springpot.host.native.trial_build import built
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive.passive_terms import hammerstein_force

HOUR_S = 4e3  # slow: more than 1e5 ticks
LAWS = {
    "rates": {"n_by_depth": 2, "rate_ratio": 16.0},
    "inverse": {"n_by_depth": 3, "rate_ratio": 1 / 16},
    "stretched": {"stretch": 12.0},
    "both": {"n_by_depth": 1, "rate_ratio": 16.0, "stretch": 6.0},
}


@cache
def model_of(kind: str, law: str, slow: bool = False) -> Model:
    fitted = small_model() if kind == "rf-fd" else plain_model()
    passive = fitted.hammerstein
    assert passive is not None
    tau_s = np.array([0.01, 0.2, 2.0, HOUR_S if slow else 0.05])
    weight = np.linspace(0.1, 0.4, 4)[:, None] * np.ones_like(passive.elastic_n)
    changed = replace(passive, tau_s=tau_s, branch_n=weight, **LAWS[law])
    return replace(fitted, hammerstein=changed)


@cache
def plain_model() -> Model:
    return fit_model("hammerstein", "x", training(), FitOptions()).model


def passive_of(model: Model) -> Hammerstein:
    assert model.hammerstein is not None
    return model.hammerstein


@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize("kind", ["hammerstein", "rf-fd"])
@pytest.mark.parametrize("slow", [False, True])
@pytest.mark.parametrize("law", LAWS)
def test_same_bits_as_the_reference(law: str, slow: bool, kind: str, number: str) -> None:
    position_m = np.concatenate([1.4 * press(2.0), press(3.0), np.full(200, 0.004)])
    position_m[300] = np.nan
    plan = make_plan(model_of(kind, law, slow), scene(number=number), accept_unsafe=True)
    given_m = position_m.astype(plan.dtype)
    with built(plan) as library:
        assert library.selftest() == 0
        assert library.state_bytes == state_bytes(plan)
        force_n = Replay(library).run(given_m, backward_velocity(given_m, DT_S))[0]
    np.testing.assert_array_equal(force_n, run_reference(plan, given_m).force_n)


@pytest.mark.parametrize("slow", [False, True])
@pytest.mark.parametrize("law", LAWS)
def test_the_emitted_force_is_the_fitted_one(law: str, slow: bool) -> None:
    model = model_of("hammerstein", law, slow)
    plan = make_plan(model, scene(number="float64"), accept_unsafe=True)
    position_m = 0.9 * press(1.0)  # below the limit of the force
    force_n = run_reference(plan, position_m).force_n
    wanted_n = hammerstein_force(passive_of(model), position_m, DT_S, np.arange(len(position_m)))
    contact = position_m > 0.02 * position_m.max()  # above it the onset fades the force in
    pushing_n = np.maximum(wanted_n, 0.0)  # a surface does not pull
    assert np.abs(force_n - pushing_n)[contact].max() < 1e-6 * wanted_n.max()


@pytest.mark.parametrize("slow", [False, True])
@pytest.mark.parametrize("law", LAWS)
def test_a_measured_step_is_the_planned_one(law: str, slow: bool) -> None:
    plan = make_plan(model_of("hammerstein", law, slow), scene(), accept_unsafe=True)
    with built(plan) as library:
        planned = library.new_state().run(press(1.0))[0]
        state = library.new_state()
        measured = [state.step_dt(DT_S, x)[0] for x in press(1.0)]
    assert np.abs(measured - planned).max() < 1e-5 * np.ptp(planned)


def test_half_the_time_step_gives_nearly_the_same_force() -> None:
    passive = passive_of(model_of("hammerstein", "both"))
    fine_m = np.interp(np.arange(0, 1000, 0.5), np.arange(1000), press(1.0))
    every = np.arange(0, len(fine_m), 2)
    coarse_n = hammerstein_force(passive, press(1.0), DT_S, np.arange(1000))
    fine_n = hammerstein_force(passive, fine_m, DT_S / 2, every)
    assert np.abs(coarse_n - fine_n).max() < 2e-3 * coarse_n.max()


def test_only_what_depends_on_the_depth_brings_its_header() -> None:
    plain, rates = (
        set(emit_files(make_plan(model, scene(), accept_unsafe=True)))
        for model in (plain_model(), model_of("hammerstein", "rates"))
    )
    assert rates - plain == {"sp_depth.h", "sp_depth_dt.h"}


@pytest.mark.parametrize("stretch", [0.5, 6.0, 12.0, 30.0])
def test_a_stretched_depth_rises_and_ends_at_one(stretch: float) -> None:
    u = np.linspace(-0.2, 1.5, 3001)
    v = stretched(u, stretch)
    assert np.all(v[u <= 0] == 0.0)
    assert np.all(np.diff(v[u >= 0]) > 0)
    assert stretched(np.array([1.0]), stretch)[0] == pytest.approx(1.0, abs=1e-12)


TICKS = (4e6, 2.4e7)


@cache
def slow_model(kind: str, *ticks: float) -> Model:
    """A fitted model whose passive part has these time constants, after a fast one."""
    model = (
        small_model() if kind == "rf-fd" else fit_model(kind, "x", training(), FitOptions()).model
    )
    passive = model.hammerstein
    assert passive is not None
    weight = np.full_like(passive.elastic_n, 0.2)
    tau_s = np.array([ticks[0] * DT_S, 0.05, *(t * DT_S for t in ticks[1:])])
    slow = replace(passive, tau_s=tau_s, branch_n=np.tile(weight, (len(tau_s), 1)))
    return replace(model, hammerstein=slow)


def run_c(model: Model, position_m: np.ndarray, number: str) -> tuple[Any, np.ndarray]:
    plan = make_plan(model, scene(number=number), accept_unsafe=True)
    with built(plan) as library:
        assert library.selftest() == 0
        assert library.state_bytes == state_bytes(plan)
        given_m = position_m.astype(plan.dtype)
        return plan, Replay(library).run(given_m, backward_velocity(given_m, DT_S))[0]


@pytest.mark.parametrize("ticks", TICKS)
def test_hours_of_relaxation_are_those_of_float64(ticks: float) -> None:
    model = slow_model("hammerstein", ticks, ticks)
    held_m = np.concatenate([press(1.0)[:500], np.full(400_000, press(1.0)[499])])
    drops_n = [
        float(force_n[5000]) - float(force_n[-1])
        for force_n in (run_c(model, held_m, number)[1] for number in ("float32", "float64"))
    ]
    assert drops_n[1] > 5e-3
    assert abs(drops_n[0] / drops_n[1] - 1) < 2e-3


def test_only_slow_branches_bring_doubles() -> None:
    names = {
        limit: set(
            emit_files(make_plan(slow_model("hammerstein", limit), scene(), accept_unsafe=True))
        )
        for limit in (0.99e5, 1.01e5)
    }
    assert names[1.01e5] - names[0.99e5] == {"sp_slow_poles.h"}
