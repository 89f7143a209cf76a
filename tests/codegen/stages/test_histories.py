"""sp_step_dt, and sp_idle with sp_step, of the same motion: the same force, the same latch."""

from functools import cache

import pytest
from support.c import golden_forces
from support.paths import C_TESTS
from support.small import scene

from springpot.emission import make_plan
from springpot.host.native.compiler import shared_library
from springpot.native import INCLUDE, CLibrary, built

HARNESS = C_TESTS / "histories_harness.c"
DECLARATIONS = """
typedef struct {
    void *step, *step_dt, *idle, *reset;
    void *by_time, *by_ticks;
    double dt_s, low_m, high_m, max_mps;
} histories_scene;
typedef struct {
    double max_difference_n;
    double peak_n;
    uint64_t samples, latched, latched_otherwise;
} histories_found;
void histories(const histories_scene *scene, uint32_t n, uint64_t seed, histories_found *found);
"""


@cache
def harness() -> CLibrary:
    return CLibrary(shared_library([HARNESS], [INCLUDE, INCLUDE / "float"]), DECLARATIONS)


@pytest.mark.parametrize(
    "count", [3000, pytest.param(1_000_000, marks=pytest.mark.slow)], ids=["few", "all"]
)
@pytest.mark.parametrize("name", ["hammerstein", "springpot", "boosted-recursive"])
def test_the_same_history_gives_the_same_force(name: str, count: int) -> None:
    plan = make_plan(golden_forces.model(name), scene(smoothing_s=2e-3))
    ffi, found = harness().ffi, harness().ffi.new("histories_found *")
    with built(plan) as library:
        states = [library.new_state() for _ in range(2)]
        told = ffi.new("histories_scene *")
        for call in ("step", "step_dt", "idle", "reset"):
            setattr(told, call, ffi.cast("void *", library.address(call)))
        told.by_time, told.by_ticks = (ffi.cast("void *", state.address) for state in states)
        told.dt_s, told.max_mps = plan.dt_s, plan.model.trained.max_mps
        told.low_m, told.high_m = -0.1 * plan.model.trained.max_m, plan.model.trained.max_m
        harness().c.histories(told, count if name == "hammerstein" else count // 10, 5, found)
    assert found.latched_otherwise == 0
    assert found.latched > 0.01 * found.samples
    # Trees see features that differ in their last bits.
    allowed = 0.05 if name == "boosted-recursive" else 0.02
    assert found.max_difference_n <= allowed * found.peak_n
