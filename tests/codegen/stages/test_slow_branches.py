"""Branches of the passive model that relax over hours: in float their states would stand still."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.small import DT_S, press, scene, small_model, training

from springpot.codegen.emit.files import emit_files
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.model.model import Model
from springpot.codegen.plan.plan import make_plan
from springpot.codegen.plan.units import state_bytes
from springpot.host.native.replay import Replay
from springpot.host.native.trial_build import built
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

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
