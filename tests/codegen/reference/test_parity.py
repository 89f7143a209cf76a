"""The built C and its numpy reference, bit for bit, on clean and on hostile motion."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.small import DT_S, press, scene, small_model, training, wandering

from springpot.codegen.emit.golden import backward_velocity, golden_positions
from springpot.codegen.plan.plan import Plan, make_plan
from springpot.codegen.reference import run as codegen_reference
from springpot.codegen.reference.notes import (
    CLAMPED,
    ENERGY,
    HELD,
    LATCHED,
    LIMITED,
    OUTSIDE,
    RAMPED,
    RESYNC,
)
from springpot.codegen.reference.run import Run, run_reference
from springpot.codegen.scene import Coupling
from springpot.codegen.stages.model_force import Stages, model_force
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.trial_build import built
from springpot.host.validation.compared import proxy_positions
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording import Recording

NUMBERS = ["float32", "float64"]
SHAPES = {
    "plain": {},
    "tool": {"mode": "tool"},
    "proxy": {"mode": "proxy"},
    "smooth": {"smoothing_s": 8.3e-4},
    "paper": {"mode": "tool", "smoothing_s": 8.3e-4},
    "m2cgen": {"forest": "m2cgen"},
}


Emitted = tuple[Plan, SceneLibrary]


def emitted(**options: Any) -> Emitted:
    """The small model's plan, and its C."""
    plan = make_plan(small_model(), scene(**options))
    with built(plan) as library:
        return plan, library


@pytest.fixture(scope="module")
def shape_of() -> Callable[[str, str], Emitted]:
    """Each shape and number type emitted once."""

    @cache
    def found(shape: str, number: str) -> Emitted:
        return emitted(number=number, **SHAPES[shape])

    return found


def compared(found: Emitted, position_m: np.ndarray, predicted: bool = True) -> tuple[Run, Run]:
    """Forces and notes of the C and of the reference; predicted: from where the C's proxy was.

    A prediction decides how long the reference takes, never what it gives: other tests verify that.
    """
    plan, library = found
    position = position_m.astype(plan.dtype)
    velocity = backward_velocity(position, plan.dt_s)
    force_n, notes = Replay(library).run(position, velocity)
    predicted_m = proxy_positions(plan, library, position, velocity) if predicted else None
    return Run(force_n, notes), run_reference(plan, position, velocity, predicted_m)


def assert_same_bits(c: Run, reference: Run) -> None:
    bits = np.uint32 if c.force_n.dtype == np.float32 else np.uint64
    np.testing.assert_array_equal(c.force_n.view(bits), reference.force_n.view(bits))
    np.testing.assert_array_equal(c.notes, reference.notes)


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("shape", list(SHAPES))
@pytest.mark.parametrize("seed", [1, 2])
def test_same_bits_on_hostile_motion(
    shape_of: Callable[[str, str], Emitted], number: str, shape: str, seed: int
) -> None:
    c, reference = compared(shape_of(shape, number), wandering(seed))
    assert_same_bits(c, reference)
    limit_n = make_plan(small_model(), scene()).output.max_n
    assert np.all((c.force_n >= 0) & (c.force_n <= limit_n))
    assert c.force_n.max() > 1.0


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize(
    ("seed", "ticks"),
    [(6, 500), *(pytest.param(seed, 4000, marks=pytest.mark.slow) for seed in (1, 2))],
)
def test_same_bits_where_the_reference_finds_the_proxy(
    shape_of: Callable[[str, str], Emitted], number: str, seed: int, ticks: int
) -> None:
    motion = np.concatenate([press(5.0), np.full(40, -1e-3), wandering(seed, ticks)])
    c, reference = compared(shape_of("proxy", number), motion, predicted=False)
    assert_same_bits(c, reference)
    assert c.force_n.max() > 1.0


def test_hostile_motion_raises_every_note() -> None:
    plan = make_plan(small_model().stiffened(4.0), scene(mode="tool"))
    seen = 0
    for seed in (1, 2, 3):
        seen |= int(np.bitwise_or.reduce(run_reference(plan, wandering(seed)).notes))
    assert seen == HELD | RESYNC | OUTSIDE | CLAMPED | RAMPED | LATCHED | LIMITED | ENERGY


def test_the_proxy_of_the_c_makes_one_pass_do_and_proves_nothing_by_itself(
    shape_of: Callable[[str, str], Emitted],
) -> None:
    plan, library = shape_of("proxy", "float32")
    position = wandering(5, 1200).astype(plan.dtype)
    velocity = np.zeros_like(position)
    predicted_m = proxy_positions(plan, library, position, velocity)
    right = run_reference(plan, position, velocity)
    for predicted in (predicted_m, 0.9 * predicted_m):
        assert_same_bits(run_reference(plan, position, velocity, predicted), right)
    assert_same_bits(Run(*Replay(library).run(position, velocity)), right)


def test_two_halves_give_what_the_whole_gives(shape_of: Callable[[str, str], Emitted]) -> None:
    _, library = shape_of("tool", "float32")
    motion = press(2.0)
    state = library.new_state()
    halves = [state.run(part)[0] for part in (motion[:217], motion[217:])]
    np.testing.assert_array_equal(np.concatenate(halves), library.new_state().run(motion)[0])


def test_a_stiff_objects_proxy_is_proven_in_bounded_work(monkeypatch: pytest.MonkeyPatch) -> None:
    # At 100 Hz nearly every tick of the golden motion upsets the prediction of all that follow.
    slow = tuple(
        Recording(item.name, item.position_m[::10], item.force_n[::10], 10 * DT_S)
        for item in training()
    )
    model = fit_model("rf-fd", "slow", slow, FitOptions(trees=5, smooth_s=0.0)).model
    chosen = replace(scene(), coupling=Coupling("proxy", 1e5, 20.0))
    plan = make_plan(model.stiffened(1000.0), chosen, accept_unsafe=True)
    position = golden_positions(plan)
    velocity = backward_velocity(position, plan.dt_s)
    lengths: list[int] = []

    def counted(stages: Stages, motion: dict[str, np.ndarray], *others: Any) -> np.ndarray:
        lengths.append(len(motion["clipped"]))
        return model_force(stages, motion, *others)

    monkeypatch.setattr(codegen_reference, "model_force", counted)
    reference = run_reference(plan, position, velocity)
    with built(plan) as library:
        c = Run(*Replay(library).run(position, velocity))
    assert_same_bits(c, reference)
    n = len(position)
    assert len(lengths) > n / 4, "the object is not stiff enough for this test"
    assert sum(lengths) < 0.6 * n * n
