"""Scenes in one loop: changed only above the surface, each with the force that it has alone."""

import time
from collections.abc import Iterator

import numpy as np
import pytest
from support.small_study import HARD, SOFT, write_scenes
from support.study.same_forces import require_same_forces

from springpot.codegen.errors import MismatchError
from springpot.host.emission.emission import emit
from springpot.host.emission.scene_file import model_path, read_scene
from springpot.host.native.loop_library import INPUT
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.wings.study.session.switched import (
    PlacedNotes,
    SwitchedScenes,
)

DT_S = 1e-3
PRESS_M = 4e-3 * np.sin(np.linspace(0, np.pi, 200))[1:-1]
AIR_M = np.full(20, -1e-3)


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> list[SceneLibrary]:
    folder = tmp_path_factory.mktemp("scenes")
    write_scenes(folder, SOFT, HARD)
    found = []
    for name in (SOFT, HARD):
        scene = read_scene(folder / f"{name}.toml")
        emit(scene, model_path(scene, folder / f"{name}.toml"), folder / name)
        found.append(SceneLibrary(folder / name))
    return found


class Ticks:
    """Calls the switch tick by tick, and keeps the rows of a log."""

    def __init__(self, scenes: list[SceneLibrary | None], latency_s: float = 0.0) -> None:
        self.switch = SwitchedScenes("float", latency_s)
        self.switch.place(scenes)
        steps = self.switch.steps()
        self._c, self._ffi = steps.library.c, steps.library.ffi
        self._state = self._ffi.cast("sp_switch *", steps.state)
        self._force = self._ffi.new("float *")
        self.rows: list[tuple[float, float, float, int]] = []

    def run(self, positions_m: np.ndarray) -> np.ndarray:
        """Forces (n,) at positions (n,)."""
        begin = len(self.rows)
        for position_m in np.asarray(positions_m, dtype=np.float32).tolist():
            notes = self._c.sp_switch_step(self._state, position_m, 0.0, self._force)
            self.rows.append((position_m, self._force[0], notes, 0))
        return np.array([row[1] for row in self.rows[begin:]])

    def idle(self, count: int) -> None:
        for _ in range(count):
            notes = self._c.sp_switch_idle(self._state, DT_S, self._force)
            self.rows.append((self.rows[-1][0], self._force[0], notes, 1))

    def reset(self) -> None:
        self._c.sp_switch_reset(self._state)

    def channels(self) -> dict[str, np.ndarray]:
        table = np.array(self.rows)
        return {INPUT: table[:, 0], "velocity_mps": 0 * table[:, 0], "notes": table[:, 2],
                "dt_s": np.full(len(table), DT_S), "returned_n": table[:, 1],
                "call": table[:, 3]}  # fmt: skip


def alone(scene: SceneLibrary, positions_m: np.ndarray) -> np.ndarray:
    state = scene.new_state()
    positions = np.asarray(positions_m, dtype=np.float32).tolist()
    return np.array([state.step(position_m)[0] for position_m in positions])


@pytest.fixture
def ticks(scenes: list[SceneLibrary]) -> Iterator[Ticks]:
    yield Ticks(list(scenes))


def test_each_scene_gives_the_force_that_it_has_alone(
    ticks: Ticks, scenes: list[SceneLibrary]
) -> None:
    whole_m = np.concatenate((AIR_M, PRESS_M, AIR_M))
    for place in (1, 2, 1):
        ticks.switch.want(place)
        assert ticks.run(whole_m).tolist() == alone(scenes[place - 1], whole_m).tolist()
        assert ticks.switch.active == place


def test_a_scene_is_changed_above_the_surface_at_zero_force_alone(ticks: Ticks) -> None:
    ticks.switch.want(1)
    ticks.run(AIR_M)
    for k in range(1, len(PRESS_M)):  # asked at every tick of a press
        ticks.run(PRESS_M[:k])
        ticks.switch.want(2)
        forces_n = ticks.run(PRESS_M[k:])
        assert ticks.switch.active == 1, "changed while it was pressed"
        after_n = ticks.run(AIR_M)
        assert ticks.switch.active == 2
        notes = PlacedNotes.of(np.array([row[2] for row in ticks.rows[-len(AIR_M) :]]))
        first = int(np.argmax(notes.place == 2))
        assert abs([*forces_n, *after_n][len(forces_n) + first - 1]) <= 1e-3
        assert notes.reset[first]
        ticks.switch.want(1)
        ticks.run(AIR_M)
        assert ticks.switch.active == 1


def test_silence_latches_whichever_slot_is_chosen_until_a_reset(ticks: Ticks) -> None:
    ticks.switch.want(1)
    ticks.run(np.concatenate((AIR_M, PRESS_M[:99])))
    assert ticks.rows[-1][1] > 0.1
    ticks.idle(300)
    assert ticks.rows[-1][1] == 0.0
    assert ticks.rows[-1][2] & 32  # latched
    for place in (2, 1, 0, 2):
        ticks.switch.want(place)
        assert not ticks.run(np.concatenate((AIR_M, PRESS_M, AIR_M))).any()
        assert ticks.rows[-1][2] & 32
    ticks.reset()
    assert ticks.run(np.concatenate((AIR_M, PRESS_M))).max() > 0.1
    assert ticks.switch.active == 2


def test_a_log_gives_the_same_forces_again(ticks: Ticks, scenes: list[SceneLibrary]) -> None:
    for place in (1, 2, 0, 2, 1):
        ticks.switch.want(place)
        ticks.run(np.concatenate((AIR_M, PRESS_M, AIR_M)))
        ticks.idle(3)
    channels = ticks.channels()
    places = PlacedNotes.of(channels["notes"]).place
    assert require_same_forces("log", channels, list(scenes)) == int(np.sum(places > 0))
    at = int(np.argmax(channels["returned_n"]))
    channels["returned_n"][at] = np.nextafter(np.float32(channels["returned_n"][at]), np.float32(9))
    with pytest.raises(MismatchError, match="1 of"):
        require_same_forces("log", channels, list(scenes))


def test_every_step_lasts_the_latency_and_longer_ones_are_counted(
    scenes: list[SceneLibrary],
) -> None:
    ticks = Ticks(list(scenes), latency_s=2e-4)
    for place in (1, 2, 0):
        ticks.switch.want(place)
        for position_m in AIR_M:
            begin_ns = time.monotonic_ns()
            ticks.run(np.array([position_m]))
            assert time.monotonic_ns() - begin_ns >= 200_000
    hasty = Ticks(list(scenes), latency_s=1e-9)
    hasty.run(AIR_M)
    assert hasty.switch.overruns == len(AIR_M)
