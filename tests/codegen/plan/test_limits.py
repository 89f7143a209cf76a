"""Limits of a scene, of any trained range, rate and guard: numbers as in explanation/output.md."""

from dataclasses import FrozenInstanceError, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from support.small import damage, passive_model, scene as small_scene

from springpot import Scene
from springpot.codegen import limits
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.make_plan import FADE_DEPTH_FRACTION, make_plan
from springpot.codegen.model.model import TrainedRange
from springpot.codegen.model.passive import Memory
from springpot.codegen.scene import Guard, Runtime
from springpot.codegen.stages.stage import SceneTicks

RATES_HZ = st.floats(10.0, 8000.0)
RANGES = st.builds(
    TrainedRange,
    min_m=st.floats(-0.3, 0.0), max_m=st.floats(1e-5, 0.3), max_mps=st.floats(1e-6, 5.0),
    min_n=st.floats(-50.0, 5.0), max_n=st.floats(1e-6, 1e4),
)  # fmt: skip
near = pytest.approx


def model(trained: TrainedRange) -> Any:
    return SimpleNamespace(trained=trained)


def ticks(rate_hz: float, surface: bool = True) -> SceneTicks:
    return SceneTicks(1.0 / rate_hz, np.float64, surface=surface)


def scene(**guard: Any) -> Scene:
    return Scene(schema=1, name="x", model="x", guard=Guard(**guard))


@given(RANGES, RATES_HZ, st.booleans())
def test_what_a_hand_may_do_is_believed(
    trained: TrainedRange, rate_hz: float, surface: bool
) -> None:
    guard = limits.build_guard_config(model(trained), 0.02, ticks(rate_hz, surface), False)
    fastest_mps = max(1.0, 8.0 * trained.max_mps)
    assert limits.compute_max_mps(model(trained)) == fastest_mps
    assert guard.max_step_m == near(max(1e-3, fastest_mps / rate_hz))  # no encoder's noise jumps
    far_m = max(0.1, 10.0 * max(-trained.min_m, trained.max_m))
    assert (guard.min_m, guard.max_m) == (-10.0 if surface else -far_m, far_m)


@given(RANGES, RATES_HZ, st.floats(3.0, 60.0))
def test_a_new_place_is_believed_before_the_watchdog_latches(
    trained: TrainedRange, rate_hz: float, watchdog_ticks: float
) -> None:
    """Two samples that agree at least, five at most."""
    guard = limits.build_guard_config(
        model(trained), watchdog_ticks / rate_hz, ticks(rate_hz), False
    )
    assert 2 <= guard.resync_ticks <= 5 and guard.resync_ticks < watchdog_ticks
    assert guard.resync_ticks == 5 or guard.resync_ticks + 2 > watchdog_ticks - 1e-9


@given(RATES_HZ)
def test_a_watchdog_waits_20_ms_or_three_ticks_and_one_bad_sample_never_latches(
    rate_hz: float,
) -> None:
    tick_ms = 1e3 / rate_hz
    assert limits.watchdog_timeout_s(scene(), 1.0 / rate_hz) == near(max(0.02, 3e-3 * tick_ms))
    fewest_ms = 2.5 * tick_ms
    stated = limits.watchdog_timeout_s(scene(watchdog_ms=fewest_ms * 1.0001), 1.0 / rate_hz)
    assert stated == near(1e-3 * fewest_ms, rel=1e-3)
    with pytest.raises(UsageError, match="or one bad sample latches") as refused:
        limits.watchdog_timeout_s(scene(watchdog_ms=fewest_ms * 0.9999), 1.0 / rate_hz)
    assert f"give at least {3 * tick_ms:g}," in str(refused.value)
    assert limits.watchdog_timeout_s(scene(watchdog_ms=2.5), 1e-3) == 0.0025
    silence = limits.build_silence_config(0.02, ticks(rate_hz))
    assert silence.dt_s * silence.rate_hz == near(1.0) and silence.dt_s == 1.0 / rate_hz
    with pytest.raises(FrozenInstanceError):
        silence.dt_s = 0.0  # type: ignore[misc]
    assert silence.watchdog_s - 0.02 == near(0.5 / rate_hz)


def test_the_stated_limit_is_one_of_pulls_too() -> None:
    pulls = TrainedRange(0.0, 0.01, 0.1, -5.0, 5.0)
    output = limits.build_output_config(model(pulls), scene(max_force_n=2.0), ticks(1000.0, False))
    assert (output.min_n, output.max_n) == (-2.0, 2.0)


@given(RANGES, RATES_HZ, st.booleans(), st.none() | st.floats(1e-3, 1e4))
def test_forces_that_leave(
    trained: TrainedRange, rate_hz: float, surface: bool, stated_n: float | None
) -> None:
    """A fifth more than was trained, unless it is stated; what has a surface never pulls."""
    limited = scene(max_force_n=stated_n)
    output = limits.build_output_config(model(trained), limited, ticks(rate_hz, surface))
    peak_n = trained.max_n if surface else max(abs(trained.max_n), abs(trained.min_n))
    assert output.max_n == (stated_n or near(1.2 * peak_n))
    if surface:
        assert output.min_n == 0.0
    else:
        assert output.min_n == near(max(-output.max_n, min(0.0, 1.2 * trained.min_n)))
    for config in (output, limits.build_guard_config(model(trained), 0.02, ticks(rate_hz), False)):
        with pytest.raises(FrozenInstanceError):
            config.max_n = 0.0  # type: ignore[misc]
    # It grows to its maximum in 4 ms, by 1.5 N a millisecond at least, and by as much in a tick.
    assert output.slew_n == near(max(1.0 / rate_hz, 1e-3) * max(1500.0, output.max_n / 0.004))
    # A latched force falls from its maximum to zero in 8 ms.
    assert output.latch_fall_n * rate_hz == near(output.max_n / 0.008)
    # A start ramps in over 50 ms.
    assert output.ramp_per_tick == near(min(1.0, 1.0 / (0.05 * rate_hz)))


@given(st.floats(-50.0, 0.0))
def test_a_model_that_never_pushes_out_is_refused_with_what_turns_it_round(max_n: float) -> None:
    of_surface = TrainedRange(0.0, 0.01, 0.1, min_n=min(max_n, -1.0), max_n=max_n)
    without_force = TrainedRange(0.0, 0.01, 0.1, min_n=0.0, max_n=0.0)
    for trained, surface in ((of_surface, True), (without_force, False)):
        with pytest.raises(DataError, match=r"never push out \(.* N\): turn the sign round") as no:
            limits.build_output_config(model(trained), scene(), ticks(1000.0, surface))
        assert f"(maximum {trained.max_n:g} N)" in str(no.value)


def test_the_fade_is_a_fraction_of_the_trained_depth_wherever_that_begins() -> None:
    model = passive_model()
    trained = replace(model.trained, min_m=0.4 * model.trained.max_m)
    always = replace(small_scene(), guard=Guard(contact="always", outside="zero"))
    plan = make_plan(replace(model, trained=trained), always)
    depth_m = 0.6 * model.trained.max_m
    assert float(plan.fade_per_m) == pytest.approx(1.0 / (FADE_DEPTH_FRACTION * depth_m))


def test_the_stiffness_is_that_of_the_rested_object_however_a_session_starts() -> None:
    """Damage softens: a hand that lets it heal meets the stiffer object."""
    model = passive_model()
    law = model.hammerstein
    assert law is not None
    curves = damage(np.full(len(law.elastic_n), 4.0 * law.elastic_n.max()))
    memory = Memory(
        np.zeros(len(law.tau_s)),
        np.zeros(0),
        np.full(4, 1.0),
        np.zeros(len(law.radius_m)),
        0.0,
        0.0,
    )
    damaged = replace(law, damage=curves, end_memory=memory)
    plans = [
        make_plan(
            replace(model, hammerstein=damaged),
            replace(small_scene(), runtime=Runtime(start=start)),
            True,
        )
        for start in ("rested", "continues")
    ]
    assert plans[0].stiffness_npm == plans[1].stiffness_npm
