"""What a hand is owed of every call: bounds, growth, no rise unseen, silence that ends in zero."""

import os
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.c import golden_forces
from support.paths import C_TESTS
from support.small import scene

from springpot.codegen.make_plan import make_plan
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.native.compiler import shared_library
from springpot.codegen.notes import LATCHED
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import build_and_load
from springpot.runtime_c.paths import INCLUDE

CALLS = 100_000_000 if os.environ.get("SPRINGPOT_SOAK") else 1_000_000
DECLARATIONS = """
typedef struct {
    void *step, *idle, *reset, *state;
    double dt_s, depth_m, watchdog_s;
    double min_n, max_n, slew_n;
    int32_t surface;
} hostile_scene;
typedef struct {
    uint64_t not_allowed, grown, risen, in_air, still_latched, silent_on;
    uint64_t latches, calls_held, pressed;
} hostile_found;
void hostile(const hostile_scene *scene, uint64_t calls, uint64_t seed, hostile_found *found);
"""
BROKEN = ("not_allowed", "grown", "risen", "in_air", "still_latched", "silent_on")


@cache
def harness(real: str) -> CLibrary:
    file = shared_library([C_TESTS / "hostile_harness.c"], [INCLUDE, INCLUDE / real])
    return CLibrary(file, DECLARATIONS)


def found_in(
    name: str, mode: str, number: str = "float32", contact: str = "surface",
    smoothing_s: float = 0.0,
) -> dict[str, int]:  # fmt: skip
    """Counts of hostile_found over CALLS calls of one scene."""
    chosen = scene(number=number, mode=mode, smoothing_s=smoothing_s)
    plan = make_plan(replace(golden_forces.model(name), contact=contact), chosen)
    tool = harness("float" if number == "float32" else "double")
    found, library = tool.ffi.new("hostile_found *"), build_and_load(plan)
    state, told = library.new_state(), tool.ffi.new("hostile_scene *")
    for call in ("step", "idle", "reset"):
        setattr(told, call, tool.ffi.cast("void *", library.address(call)))
    told.state = tool.ffi.cast("void *", state.address)
    told.dt_s, told.depth_m = plan.dt_s, plan.model.trained.max_m
    told.watchdog_s, told.surface = plan.watchdog_s, plan.contact
    told.min_n, told.max_n = float(plan.output.min_n), float(plan.output.max_n)
    told.slew_n = float(plan.output.slew_n)
    tool.c.hostile(told, CALLS, 3, found)
    return {member: getattr(found, member) for member, _ in tool.ffi.typeof("hostile_found").fields}


FAST = [("hammerstein", {"mode": mode}) for mode in ("off", "tool", "proxy")]
SLOW = [
    *((name, {"mode": mode, "number": number})
      for name in golden_forces.models() for number, mode in golden_forces.EACH_MODE),
    ("rbf-pv", {"mode": "proxy", "contact": "always"}),
    ("hammerstein", {"mode": "tool", "contact": "always", "smoothing_s": 8e-4}),
    ("hammerstein", {"mode": "off", "smoothing_s": 0.02}),
    ("rf-fd", {"mode": "proxy"}),
]  # fmt: skip


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "options"), [*FAST, *(pytest.param(*each, marks=pytest.mark.slow) for each in SLOW)]
)
def test_no_call_breaks_what_a_hand_is_owed(name: str, options: dict[str, str | float]) -> None:
    """With any coupling, kind and number, and with what few scenes have."""
    found = found_in(name, **options)  # type: ignore[arg-type]
    assert not any(found[broken] for broken in BROKEN), found
    # The calls visited what the laws are about.
    assert found["pressed"] > 0.1 * CALLS and found["calls_held"] > 0.02 * CALLS
    assert found["latches"] > 20


@pytest.mark.parametrize("mode", ["off", "proxy"])
def test_a_source_that_misses_every_third_sample_ends_within_half_a_second(mode: str) -> None:
    """What a drive sends for an estimate that is not valid is 0.0: the surface itself."""
    plan = make_plan(golden_forces.model("hammerstein"), scene(mode=mode))
    depth_m = 0.8 * plan.model.trained.max_m
    position_m = depth_m * np.minimum(np.arange(900) / 300, 1.0)
    position_m[300::3] = 0.0
    library = build_and_load(plan)
    force_n, notes = Replay(library).run(position_m.astype(plan.dtype), np.zeros(900, plan.dtype))
    ended = int(np.flatnonzero(notes & LATCHED)[0])
    assert 300 < ended <= 800
    rises_n = np.diff(force_n[300:])
    assert rises_n.max() <= plan.output.slew_n and not force_n[ended + 10 :].any()


@pytest.mark.parametrize("mode", ["off", "proxy"])
def test_a_lone_zero_at_depth_is_held(mode: str) -> None:
    """As a bus gives it that failed to read."""
    plan = make_plan(golden_forces.model("hammerstein"), scene(mode=mode))
    state, depth_m = build_and_load(plan).new_state(), 0.8 * plan.model.trained.max_m
    for position_m in np.linspace(0.0, depth_m, 400):
        held_n = state.step(float(position_m))[0]
    assert state.step(0.0)[0] == held_n > 0.0
    assert state.step(0.0)[0] == 0.0  # two in a row: the tool may be there
