"""The loop in C, the thread of runtime_c/port/posix, and the functions that it calls each tick."""

import os
import sys
from dataclasses import asdict, dataclass, field

from springpot.codegen.entry_points import blame_package
from springpot.codegen.errors import DeviceError
from springpot.codegen.messages import short_repr
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.notes import LATCHED
from springpot.codegen.types import CData
from springpot.host.devices.device import OpenedDevice
from springpot.host.native.c_library import (
    GOT_CPU,
    GOT_FIFO,
    GOT_LOCKED,
    GOT_SLACK,
    LoopRows,
    empty_rows,
    loop_library,
)
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.session.outcome import LinkCounts, LoopSettings, LoopState

_RING_S = 16.0  # of rows that wait while Python does something else
_PRIORITY = 80
_FIRST = "TIME_CRITICAL" if sys.platform == "win32" else "SCHED_FIFO"


@dataclass(frozen=True)
class StepFunctions:
    """Addresses of the three functions and of the state that a loop calls; library: its C."""

    library: CLibrary
    step: int
    idle: int
    reset: int
    state: int
    measured_n: int = 0  # where the state wants the measured force, or 0
    owners: CData = field(default=None, repr=False)  # owners of the memory behind the addresses
    __repr__ = short_repr


def scene_step_functions(scene: SceneLibrary, place_m: tuple[float, float] | None) -> StepFunctions:
    """Return a fresh state of a scene, at a place if it has a map."""
    state = scene.new_state(place_m)
    step, idle, reset = (scene.address(name) for name in ("step", "idle", "reset"))
    owners = (scene, state)
    return StepFunctions(loop_library(scene.real), step, idle, reset, state.address, owners=owners)


class CLoop:
    """A thread of C on absolute deadlines; Python only watches."""

    def __init__(self, steps: StepFunctions, settings: LoopSettings) -> None:
        """Allocate the loop's memory and the ring by which its rows reach Python."""
        self._steps, self._settings = steps, settings
        self._library = steps.library
        self._c, self._ffi = steps.library.c, steps.library.ffi
        self._loop = self._library.memory(self._c.sp_loop_size(), "sp_loop")
        capacity = 1 << max(10, int(_RING_S / settings.period_s - 1).bit_length())
        self._ring = empty_rows(capacity)
        self._chunk = empty_rows(capacity)
        self._state = self._ffi.new("sp_loop_state *")
        self._links: list[CData] = []
        self._owners: list[CData] = []
        self._ticking = False

    def start(self, device: OpenedDevice) -> None:
        """Start the thread. Raises DeviceError where the system gives none."""
        steps = self._steps
        pointer = self._library.pointer
        cpus = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
        config = self._ffi.new(
            "sp_loop_config *",
            {
                "step": pointer(steps.step),
                "idle": pointer(steps.idle),
                "reset": pointer(steps.reset),
                "state": pointer(steps.state),
                "measured_n": self._ffi.cast("double *", steps.measured_n),
                **asdict(self._settings),
                "latched_note": LATCHED,
                "priority": _PRIORITY,
                "cpu": cpus[-1] if len(cpus) > 1 else -1,  # the last one is spare
                "rows": self._rows(self._ring),
                "capacity": len(self._ring),
            },
        )
        error = self._c.sp_loop_start(self._loop, config, self._adopt(device))
        if error:
            raise DeviceError(
                f"no thread for the loop: {os.strerror(error)}: free memory or limits"
            )
        self._ticking = True

    def attach(self, device: OpenedDevice) -> None:
        """Go on with a device that came back."""
        self._c.sp_loop_attach(self._loop, self._adopt(device))

    def ask_stop(self) -> None:
        """End with zero force."""
        if self._ticking:
            self._c.sp_loop_request_stop(self._loop)

    def sense(self, measured_n: float) -> None:
        """A sensor beside the device measured this, just now; from any thread."""
        self._c.sp_loop_set_measured_force(self._loop, measured_n)

    def pause(self, paused: bool) -> None:
        """Zero force, and no calls until it is resumed; then the scene is reset."""
        self._c.sp_loop_pause(self._loop, int(paused))

    def reset(self) -> None:
        """Reset the scene, and a device that tripped."""
        self._c.sp_loop_reset(self._loop)

    def get_status(self) -> LoopState:
        if not self._links:
            return LoopState()
        self._c.sp_loop_get_status(self._loop, self._state)
        return LoopState(
            **{name: getattr(self._state, name) for name in LoopState.__dataclass_fields__}
        )

    def counts(self) -> LinkCounts:
        return LinkCounts(
            **{
                name: sum(getattr(link, name) for link in self._links)
                for name in LinkCounts.__dataclass_fields__
            }
        )

    def drain(self) -> LoopRows:
        """Return rows since the last call."""
        if not self._links:
            return empty_rows()
        count = self._c.sp_loop_drain(self._loop, self._rows(self._chunk), len(self._chunk))
        return self._chunk[:count].copy()

    def join(self) -> None:
        """Wait for the end of the thread: at most a period and what the device takes."""
        if self._ticking:
            self._c.sp_loop_join(self._loop)
            self._ticking = False

    def scheduler(self) -> str:
        """Return who keeps the time, and what the system granted for it."""
        got = self.get_status().got
        words = {GOT_LOCKED: "memory locked", GOT_CPU: "own CPU", GOT_SLACK: "1 ns timer slack"}
        named = [name for bit, name in words.items() if got & bit]
        policy = _FIRST if got & GOT_FIFO else "SCHED_OTHER"
        return ", ".join(["C thread", policy, *named])

    def refused(self) -> str:
        """Return what the system refused of that, and what to do; empty if nothing."""
        if self.get_status().got & GOT_FIFO:
            return ""
        return (
            f"the system refused {_FIRST}, ticks may be late: `springpot doctor` says how to allow "
            "it"
        )

    def _rows(self, table: LoopRows) -> CData:
        return self._ffi.from_buffer("sp_row[]", table)

    def _adopt(self, device: OpenedDevice) -> CData:
        """Return the device's link, kept alive while C may call it. Raises TypeError for none."""
        with blame_package(f"{type(device).__name__}.link", type(device), DeviceError):
            link = device.link(self._library)
            if not (link and link.read and link.write and link.reset):
                raise TypeError("returns no sp_link that has read, write and reset")
        self._links.append(link)
        self._owners.append(device)
        return link
