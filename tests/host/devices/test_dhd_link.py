"""The C link of a Force Dimension device, over functions of an SDK that a test gives it."""

import numpy as np
import pytest

from springpot.host.native.c_library import loop_library

PLACE_M, MS = (0.03, 0.01, 0.05), 1_000_000


class Sdk:
    """answers: what dhdGetPosition returns next; place_m: and where. forces: what came."""

    def __init__(self, **settings: float) -> None:
        self.library = loop_library("double")
        ffi, c = self.library.ffi, self.library.c
        self.answer, self.place_m, self.forces, self.put = 0, PLACE_M, [], 0
        self.speeds_mps = (0.0, 0.0, 0.0)
        types = dict(ffi.typeof("sp_dhd").fields)
        calls = {
            "get_position": self._position,
            "get_linear_velocity": lambda x, y, z, _id: self._put((x, y, z), self.speeds_mps),
            "set_force": lambda x, y, z, _id: self.forces.append((x, y, z)) or self.put,
            "get_status": self._status,
            "get_button": lambda _index, _id: 0,
            "enable_force": lambda _on, _id: 0,
            "error_get_last": lambda: 2,
        }
        self._kept = {name: ffi.callback(types[name].type, call) for name, call in calls.items()}
        dhd = ffi.new("sp_dhd *", {**self._kept, "axis": 2, "sign": -1.0, "line_m": PLACE_M,
                                   "max_n": 8.0, "max_call_s": 1.0, **settings})  # fmt: skip
        self._memory = self.library.memory(c.sp_link_dhd_size())
        self.link = c.sp_link_dhd_init(self._memory, dhd)
        self.motion = ffi.new("sp_motion *")
        self.link.reset(self.link, 1)

    def tick(self, now_ms: int, force_n: float = 0.0) -> int:
        fresh = self.link.read(self.link, now_ms * MS, self.motion, 1)
        self.link.write(self.link, now_ms * MS, force_n)
        return int(fresh)

    def _position(self, x: object, y: object, z: object, _id: object) -> int:
        self._put((x, y, z), self.place_m)
        return self.answer

    def _put(self, places: tuple, values: tuple) -> int:
        for place, value in zip(places, values, strict=True):
            place[0] = value
        return 0

    def _status(self, status: object, _id: object) -> int:
        status[5] = 1
        return 0


def test_walls_pull_nowhere_before_the_first_place_and_hold_after_it() -> None:
    sdk = Sdk(wall_npm=1000.0)
    sdk.answer, sdk.place_m = 1, (9.0, 9.0, 9.0)  # read before, and said so
    assert sdk.tick(1) == 0 and sdk.forces[-1] == (0.0, 0.0, 0.0)
    sdk.answer, sdk.place_m = 0, (0.031, 0.01, 0.05)
    assert sdk.tick(1001, 2.0) == 1
    assert sdk.forces[-1] == pytest.approx((-1.0, 0.0, 2.0))  # axis -z: the object pushes up
    sdk.place_m = (1.0, 0.01, 0.05)
    for now_ms in range(1002, 1010):
        sdk.tick(now_ms)
    assert sdk.forces[-1] == pytest.approx((-8.0, 0.0, 0.0))  # no more than the scene
    sdk.link.released = 1
    sdk.tick(1010)
    assert sdk.forces[-1] == (0.0, 0.0, 0.0)


def test_walls_brake_a_tool_that_leaves_its_line_and_one_that_comes_back() -> None:
    sdk, forces_n = Sdk(wall_npm=1000.0), []
    sdk.tick(1)
    for speed_mps in (0.05, 0.0, -0.05):
        sdk.place_m, sdk.speeds_mps = (PLACE_M[0] + 1e-3, *PLACE_M[1:]), (speed_mps, 0.0, 0.0)
        for now_ms in range(1001, 1020):
            sdk.tick(now_ms)
        forces_n.append(sdk.forces[-1][0])
    assert forces_n[1] == pytest.approx(-1.0) and forces_n[0] < forces_n[1] < forces_n[2]


@pytest.mark.parametrize("seed", range(20))
def test_walls_rise_from_zero_after_resets_and_pauses_and_never_at_once(seed: int) -> None:
    """Whatever is reset, paused, unread or moved: within a second, by a quarter a tick at most."""
    rng = np.random.default_rng(seed)
    sdk = Sdk(wall_npm=10 ** rng.uniform(1, 4))
    max_n, since_ms, before_n = 8.0, 0, np.zeros(2)
    for now_ms in range(1, 4000):
        what = rng.integers(0, 400)
        if what == 0:
            sdk.link.reset(sdk.link, now_ms * MS)
            since_ms, before_n = now_ms, np.zeros(2)
        elif what == 1:
            sdk.link.released = 1 - sdk.link.released
        sdk.answer = int(rng.choice([0, 1, -1], p=[0.7, 0.2, 0.1]))
        if rng.integers(0, 10) == 0:
            sdk.place_m = tuple(np.array(PLACE_M) + rng.normal(0, 0.01, 3))
        sdk.tick(now_ms, float(rng.uniform(0, 5)))
        wall_n = np.array(sdk.forces[-1][:2])
        since_ms = now_ms if sdk.link.released else since_ms
        assert np.all(np.abs(wall_n) <= max_n * min(1.0, (now_ms - since_ms) / 1000) + 1e-9)
        grown_n = np.where(wall_n * before_n < 0, 0.0, np.abs(before_n)) + max_n / 4
        assert np.all(np.abs(wall_n) <= grown_n + 1e-9)
        before_n = wall_n


def test_a_force_that_is_not_taken_ends_nothing_two_in_a_row_do() -> None:
    sdk, ends = Sdk(), []
    for now_ms, sdk.put in enumerate([-1, 0, -1, 0, -1, 0, 0, -1, -1]):
        sdk.link.read(sdk.link, now_ms * MS, sdk.motion, 1)
        ends.append(sdk.link.write(sdk.link, now_ms * MS, 1.0))
    assert ends == [1, 0, 1, 0, 1, 0, 0, 1, sdk.library.c.SP_LINK_TRIPPED]


def test_the_handle_is_taken_up_within_a_second() -> None:
    sdk, up_n = Sdk(weight_n=2.0), []
    for now_ms in (1, 501, 1001, 3001):
        sdk.tick(now_ms)
        up_n.append(sdk.forces[-1][2])
    assert up_n == pytest.approx([0.0, 1.0, 2.0, 2.0])
    sdk.link.released = 1
    sdk.tick(3002)
    assert sdk.forces[-1][2] == 0.0
