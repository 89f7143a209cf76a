"""Replay of positions through a scene's C, and the time its ticks take."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.emit.golden import differentiate
from springpot.codegen.errors import SpringpotError
from springpot.codegen.native.c_library import CLibrary, load_c
from springpot.codegen.plan import Plan
from springpot.host.metrics import Accuracy, accuracy, find_contacts, start_up_ramp
from springpot.host.native.c_library import INPUT
from springpot.host.native.scene_library import SceneLibrary
from springpot.runtime_c.paths import PORT_TESTBENCH
from springpot.trainer.models.depths import DepthMotion, join_motions, pauses_to_ticks
from springpot.trainer.recordings.recording import Recording

COLD_BYTES = 8 << 20
_HOT_TICKS = 500


@dataclass(frozen=True, eq=False)
class TickTimes:
    """Time of one tick, ns: hot (in a tight loop), and paced with cold caches."""

    hot_median: float
    p50: float
    p99: float
    p999: float
    max: float


class Replay:
    """Runs one scene's sp_step from C, tick by tick."""

    def __init__(self, library: SceneLibrary) -> None:
        self._library = library
        self._port = load_port(library.real)
        self._step = self._port.pointer(library.address("step"))

    def run(
        self,
        position_m: Reals,
        velocity_mps: Reals | None = None,
        *,
        place_m: tuple[float, float] | None = None,
    ) -> tuple[Reals, Reals]:
        """Return forces (N) and notes of each tick from a fresh state; shapes (n,).

        velocity_mps: by default backward differences of the positions. place_m: x and y, if the
        scene has a map.
        """
        position = self._converted(position_m)
        velocity = self._velocity(position) if velocity_mps is None else velocity_mps
        velocity = self._converted(velocity)
        force = np.empty_like(position)
        notes = np.empty(len(position), dtype=np.int32)
        state = self._library.new_state(place_m)
        array = self._port.array
        self._port.c.sp_replay(
            self._step, self._port.pointer(state.address), len(position),
            array(position), array(velocity), array(force), array(notes),
        )  # fmt: skip
        return force, notes

    def repeat(
        self, calls: Mapping[str, Reals], place_m: tuple[float, float] | None = None
    ) -> tuple[Reals, Reals]:
        """Make the calls of a session's log again, from a fresh state: forces (N) and notes, (n,).

        calls: the channels of the log, see `session/session.py`. Rows without a call stay 0.
        """
        made = np.ascontiguousarray(calls["call"], dtype=np.int32)
        force = np.zeros(len(made), dtype=self._library.dtype)
        notes = np.zeros(len(made), dtype=np.int32)
        state = self._library.new_state(place_m)
        inputs = [self._converted(calls[name]) for name in (INPUT, "velocity_mps", "dt_s")]
        pointer, array = self._port.pointer, self._port.array
        functions = [pointer(self._library.address(name)) for name in ("step", "idle", "reset")]
        self._port.c.sp_replay_calls(
            *functions, pointer(state.address), len(made), array(made), *map(array, inputs),
            array(force), array(notes),
        )  # fmt: skip
        return force, notes

    def tick_times(self, position_m: Reals, paced_s: float) -> TickTimes:
        """Time ticks hot over all samples, and paced at the scene's rate for `paced_s`."""
        hot, paced = self.hot_ns(position_m), self._paced_ns(position_m, paced_s)
        p50, p99, p999, longest = map(float, np.percentile(paced, [50, 99, 99.9, 100]))
        return TickTimes(hot, p50, p99, p999, longest)

    def hot_ns(self, position_m: Reals) -> float:
        """Median time of a tick in a tight loop over all samples, ns."""
        position = self._converted(position_m)
        velocity, state = self._velocity(position), self._library.new_state()
        state.run(position, velocity)  # warms the caches
        state.reset()
        times = []
        for begin in range(0, len(position), _HOT_TICKS):
            rows = slice(begin, begin + _HOT_TICKS)
            clock = time.perf_counter_ns()
            state.run(position[rows], velocity[rows])
            times.append((time.perf_counter_ns() - clock) / len(position[rows]))
        return float(np.median(times))

    def _paced_ns(self, position_m: Reals, paced_s: float) -> Reals:
        """Time ticks that come at the scene's rate, with its tables out of the cache, ns."""
        dt_s, position = self._library.manifest["dt_s"], self._converted(position_m)
        ticks = max(100, round(paced_s / dt_s))
        rows = np.arange(ticks) % len(position)
        position, velocity = position[rows], self._velocity(position)[rows]
        cold = np.zeros(COLD_BYTES, dtype=np.uint8)
        tick_ns = np.empty(ticks)
        state = self._library.new_state()
        array = self._port.array
        error = self._port.c.sp_replay_time_ticks(
            self._step, self._port.pointer(state.address), ticks, array(position),
            array(velocity), min(dt_s, paced_s / ticks), array(cold), COLD_BYTES, array(tick_ns),
        )  # fmt: skip
        if error != 0:
            raise SpringpotError(f"the monotonic clock failed (error {error}) while timing ticks")
        return tick_ns

    def _velocity(self, position: Reals) -> Reals:
        return differentiate(position, self._library.manifest["dt_s"])

    def _converted(self, values: Reals) -> Reals:
        return np.ascontiguousarray(values, dtype=self._library.dtype)


@cache
def load_port(real: str) -> CLibrary:
    """sp_replay.h for scenes of `real` ("float" or "double"), built and loaded once."""
    return load_c([PORT_TESTBENCH / "sp_replay.h"], [PORT_TESTBENCH / "sp_replay.c"], real)


def replay_motions(plan: Plan, recordings: Sequence[Recording]) -> list[DepthMotion]:
    """Yield the C's inputs: each recording from a fresh state, those of one session in a row."""
    positions = [recording.position_m for recording in recordings]
    return [
        pauses_to_ticks(motion, plan.dt_s)
        for motion in join_motions(recordings, positions, plan.contact)
    ]


def replay_forces(
    plan: Plan, replay: Replay, recordings: Sequence[Recording]
) -> tuple[list[Samples], list[int]]:
    """Forces of the C along recordings, (n,), N, and the samples of each in the start-up ramp."""
    forces = [np.zeros(0)] * len(recordings)
    ramps = [0] * len(recordings)
    for motion in replay_motions(plan, recordings):
        place_m = recordings[motion.recordings[0]].place_m if plan.has_places else None
        force_n, notes = replay.run(motion.depth_m, place_m=place_m)
        ramps[motion.recordings[0]] = start_up_ramp(notes[motion.starts[0] :])
        for number, start in zip(motion.recordings, motion.starts, strict=True):
            rows = slice(start, start + len(recordings[number].force_n))
            forces[number] = force_n[rows].astype(np.float64)
    return forces, ramps


def replay_accuracy(plan: Plan, replay: Replay, recordings: Sequence[Recording]) -> Accuracy:
    """Error of the C on recordings, behind the start-up ramp."""
    forces, ramps = replay_forces(plan, replay, recordings)
    contacts = find_contacts(recordings, plan.contact)
    return accuracy([recording.force_n for recording in recordings], forces, ramps, contacts)
