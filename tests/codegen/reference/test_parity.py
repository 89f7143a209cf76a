"""The built C and its numpy reference, bit for bit, on clean and hostile motion, and in silence."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.c import golden_forces
from support.c.same_bits import require_same_bits
from support.small import DT_S, press, scene, small_model, training, wandering

from springpot import Recording
from springpot.codegen import reference as codegen_reference
from springpot.codegen.arrays import Samples
from springpot.codegen.emit.golden import golden_positions
from springpot.codegen.make_plan import make_plan
from springpot.codegen.notes import CLAMPED, HELD, LATCHED, LIMITED, OUTSIDE, RAMPED, RESYNC
from springpot.codegen.plan import Plan
from springpot.codegen.reference import run_reference
from springpot.codegen.scene import Coupling
from springpot.codegen.stages.model_stages import Stages, compute_model_force
from springpot.codegen.tool_motion import SILENCE_PAYBACK
from springpot.host.native.scene_library import build_and_load
from springpot.host.validation.compared import proxy_positions
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

NUMBERS = ["float32", "float64"]
SHAPES = {
    "plain": {},
    "tool": {"mode": "tool"},
    "proxy": {"mode": "proxy"},
    "smooth": {"smoothing_s": 8.3e-4},
    "paper": {"mode": "tool", "smoothing_s": 8.3e-4},
}


def plan_of(shape: str, number: str = "float32") -> Plan:
    return make_plan(small_model(), scene(number=number, **SHAPES[shape]))


@pytest.mark.few(1)
@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("shape", list(SHAPES))
@pytest.mark.parametrize("seed", [1, 2])
def test_same_bits_on_hostile_motion(number: str, shape: str, seed: int) -> None:
    plan = plan_of(shape, number)
    force_n, _ = require_same_bits(plan, wandering(seed))
    assert np.all((force_n >= 0) & (force_n <= plan.output.max_n)) and force_n.max() > 1.0


@pytest.mark.few(0, 4)
@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize(("seed", "ticks"), [(6, 500), (1, 4000), (2, 4000)])
def test_same_bits_where_the_reference_finds_the_proxy(number: str, seed: int, ticks: int) -> None:
    motion = np.concatenate([press(5.0), np.full(40, -1e-3), wandering(seed, ticks)])
    force_n, _ = require_same_bits(plan_of("proxy", number), motion, find=True)
    assert force_n.max() > 1.0


def test_hostile_motion_raises_every_note() -> None:
    plan = make_plan(small_model().stiffened(4.0), scene(mode="tool"))
    seen = 0
    for seed in (1, 2, 3):
        seen |= int(np.bitwise_or.reduce(run_reference(plan, wandering(seed)).notes))
    assert seen == HELD | RESYNC | OUTSIDE | CLAMPED | RAMPED | LATCHED | LIMITED


@pytest.mark.slow
def test_the_proxy_of_the_c_makes_one_pass_do_and_proves_nothing_by_itself() -> None:
    plan = plan_of("proxy")
    position = wandering(5, 1200).astype(plan.dtype)
    velocity = np.zeros_like(position)
    force_n, notes = require_same_bits(plan, position, velocity, find=True)
    predicted_m = proxy_positions(plan, build_and_load(plan), position, velocity)
    for predicted in (predicted_m, 0.9 * predicted_m):
        found = run_reference(plan, position, predicted)
        np.testing.assert_array_equal(found.force_n, force_n)
        np.testing.assert_array_equal(found.notes, notes)


def test_two_halves_give_what_the_whole_gives() -> None:
    motion, library = press(2.0), build_and_load(plan_of("tool"))
    state = library.new_state()
    halves = [state.run(part)[0] for part in (motion[:217], motion[217:])]
    np.testing.assert_array_equal(np.concatenate(halves), library.new_state().run(motion)[0])


@pytest.mark.slow
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
    lengths: list[int] = []

    def counted(stages: Stages, motion: dict[str, np.ndarray], *others: Any) -> np.ndarray:
        lengths.append(len(motion["clipped"]))
        return compute_model_force(stages, motion, *others)

    monkeypatch.setattr(codegen_reference, "compute_model_force", counted)
    require_same_bits(plan, position, find=True)
    n = len(position)
    assert len(lengths) > n / 4, "the object is not stiff enough for this test"
    assert sum(lengths) < 0.6 * n * n


KINDS = ("hammerstein", "rf-fd", "rbf-fd", "rbf-pv", "rbf-pv averaged", "rf-fd-long",
         "rf-history-quantised")  # fmt: skip
MODES = ("off", "tool", "proxy")
SMOOTH_S = 3e-3


@cache
def silent_plan(name: str, mode: str, number: str = "float32") -> Plan:
    chosen = scene(number=number, mode=mode, smoothing_s=SMOOTH_S if number == "float64" else 0.0)
    model = golden_forces.model(name.removesuffix(" averaged"))
    if name.endswith("averaged"):
        model = replace(model, features=replace(model.features, weight=0.7))
    return make_plan(model, chosen)


def strokes(plan: Plan, ticks: int, low: float = 0.1, speed: float = 1.0) -> Samples:
    """In and out between `low` and 0.95 of the trained depth; at the top speed, the trained one."""
    trained = plan.model.trained
    base_m = 0.0 if plan.contact else trained.min_m
    span_m = trained.max_m - base_m
    per_s = 2.0 * speed * trained.max_mps / ((0.95 - low) * span_m)
    wave = 0.5 * (1.0 - np.cos(per_s * DT_S * np.arange(ticks)))
    return np.asarray(base_m + span_m * (low + (0.95 - low) * wave))


def gaps(plan: Plan, ticks: int, seed: int) -> np.ndarray:
    """Draw ticks without a sample, (ticks,): gaps of at most the watchdog's time."""
    rng, longest = np.random.default_rng(seed), round(plan.watchdog_s / plan.dt_s)
    lost, i = np.zeros(ticks, dtype=bool), 150
    while i < ticks - longest:
        gap = int(rng.integers(1, longest + 1))
        lost[i : i + gap] = True
        i += gap + int(gap / SILENCE_PAYBACK) + int(rng.integers(1, 60))
    return lost


@pytest.mark.few(1)
@pytest.mark.parametrize(("number", "mode"), golden_forces.EACH_MODE)
@pytest.mark.parametrize("name", KINDS)
def test_the_reference_gives_the_same_bits(name: str, mode: str, number: str) -> None:
    plan = silent_plan(name, mode, number)
    position = strokes(plan, 700, low=-0.1)
    position[gaps(plan, 700, 1)] = np.nan
    force_n, notes = require_same_bits(plan, position, np.zeros(700, plan.dtype))
    assert force_n.max() > 0.5 and np.any(notes & HELD)


def test_a_silence_does_not_hurry_a_ramp() -> None:
    """After a start at depth, of a tool that withdraws while no sample comes."""
    plan, position = silent_plan("hammerstein", "off"), np.repeat([8e-3, 5e-3], [10, 50])
    whole_n, _ = require_same_bits(plan, position)
    position[10:14] = np.nan
    force_n, notes = require_same_bits(plan, position)
    assert np.all(notes[14:40] & RAMPED) and np.all(force_n[14:40] < whole_n[14:40])


def test_samples_far_away_are_believed_only_in_a_row() -> None:
    plan, position = silent_plan("hammerstein", "off"), np.full(200, 5e-3)
    position[100:104] = position[105:109] = 0.09  # a fifth in a row is taken as true
    position[104] = np.nan
    _, notes = require_same_bits(plan, position)
    assert np.all(notes[100:109] & HELD) and not np.any(notes[1:] & RESYNC)
    position[109] = 0.09
    assert require_same_bits(plan, position)[1][109] & RESYNC


@pytest.mark.few(1)
@pytest.mark.parametrize("mode", MODES)
def test_silence_beyond_the_watchdog_is_latched_at_zero(mode: str) -> None:
    plan = silent_plan("hammerstein", mode)
    position, longest = strokes(plan, 400), round(plan.watchdog_s / plan.dt_s)
    position[200 : 201 + longest] = np.nan
    force_n, notes = require_same_bits(plan, position)
    assert not notes[199 + longest] & LATCHED and np.all(notes[200 + longest :] & LATCHED)
    assert not force_n[220 + longest :].any()
