"""Whatever lies in the memory of a state: refused, or a force within the scene's limits."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from support.c import golden_forces
from support.small import press

from springpot.codegen.make_plan import make_plan
from springpot.codegen.plan import Plan, list_state_members, member_offset
from springpot.codegen.stages.stage import DOUBLE, REAL, U32, round_up
from springpot.host.native.scene_library import SceneLibrary, build_and_load

STATE = -3
HOSTILE = (np.nan, np.inf, -np.inf, 3e38, -3e38, 1e30, -1e30, 1e-42, 1.0, -1.0, 0.0)
NAMES = golden_forces.models()


def plan(name: str, number: str) -> Plan:
    scene = golden_forces.scene(name, number, "proxy" if number == "float32" else "off")
    return make_plan(golden_forces.model(name), scene, accept_unsafe=True)


class Calls:
    """All calls of a scene on one memory, and the forces that they write."""

    def __init__(self, library: SceneLibrary) -> None:
        self._library, loaded = library, library.loaded
        self.state: Any = loaded.memory(library.state_bytes, "sp_state")
        self.bytes = np.frombuffer(loaded.ffi.buffer(self.state, library.state_bytes), np.uint8)
        self.force = loaded.ffi.new(f"{library.real} *")

    def init(self) -> None:
        self._library.function("init")(self.state)

    def all(self, at_m: float, dt_s: float = 1e-3) -> Iterator[tuple[int, float]]:
        """Note or error, and the force, of each call; dt_s: of those that take a time."""
        arguments = {"step": (at_m, 0.0), "idle": (dt_s,), "advance": (dt_s, at_m)}
        for name, its in arguments.items():
            found = self._library.function(name)(self.state, *its, self.force)
            yield found, self.force[0]


@pytest.mark.few(1)
@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize("name", NAMES)
def test_memory_that_init_never_saw_is_refused(name: str, number: str) -> None:
    random, library = np.random.default_rng(1), build_and_load(plan(name, number))
    calls = Calls(library)
    for fill in (0x00, 0xCD, 0xFF, None):
        any_bytes = random.integers(0, 256, library.state_bytes)
        calls.bytes[:] = any_bytes if fill is None else fill
        before = calls.bytes.copy()
        for found, force_n in calls.all(0.002):
            assert found == STATE and force_n == 0.0
        np.testing.assert_array_equal(calls.bytes, before)


def numbers_of(plan: Plan) -> Iterator[tuple[int, type[Any]]]:
    """Offset and type of every number in a state that is no index, after the word of sp_init."""
    types: dict[str, type[Any]] = {REAL: plan.dtype, DOUBLE: np.float64, U32: np.uint32}
    for member in list_state_members(plan):
        at = member_offset(plan, member.declaration.split()[-1].split("[")[0])
        for scalar in member.scalars:
            at = round_up(at, np.dtype(types[scalar]).itemsize)
            if scalar != U32:
                yield at, types[scalar]
            at += np.dtype(types[scalar]).itemsize


@pytest.mark.few(5)
@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize("name", NAMES)
def test_a_damaged_state_gives_a_force_within_its_limits_and_ends(name: str, number: str) -> None:
    random, planned = np.random.default_rng(2), plan(name, number)
    places, min_n = list(numbers_of(planned)), float(planned.output.min_n)
    library = build_and_load(planned)
    calls = Calls(library)
    for _ in range(60):
        calls.init()
        for at_m in press(1.0)[: random.integers(1, 400) : 40]:
            list(calls.all(float(at_m)))
        damaged = random.random(len(places)) < random.choice([0.02, 0.3, 1.0])
        with np.errstate(over="ignore"):
            for (at, dtype), hit in zip(places, damaged, strict=True):
                if hit:
                    number_there = np.array([random.choice(HOSTILE)], dtype)
                    calls.bytes[at : at + dtype(0).nbytes] = number_there.view(np.uint8)
        longer_s = float(random.choice([1e-3, 0.015, 1e6]))
        for at_m in (0.003, 0.0031, np.nan, 0.0035, -0.001, 0.002):
            for found, force_n in calls.all(at_m, longer_s):
                assert found >= 0 and min_n <= force_n <= float(planned.output.max_n)
