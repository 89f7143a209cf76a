"""Settings, state and counters of a loop, which Python or C may keep the time of."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from springpot.codegen.short_repr import short_repr

if TYPE_CHECKING:
    from springpot.host.devices.device import OpenedDevice
    from springpot.host.native.loop_library import LoopRows


@dataclass(frozen=True)
class LoopSettings:
    """period_s: of a tick. seconds: 0, until it is stopped. Beyond the limits the loop ends.

    reversed: the device pulls for a positive force. sensed: a sensor beside the device measures.
    """

    period_s: float
    seconds: float = 0.0
    max_force_n: float = float("inf")
    max_depth_m: float = float("inf")
    reversed: bool = False
    sensed: bool = False
    real_time: bool = True


@dataclass(frozen=True)
class LoopState:
    """What sp_loop_get_status returns; counts since the start, flags, link counters."""

    ticks: int = 0
    late: int = 0
    stale: int = 0
    unused: int = 0
    ring_dropped: int = 0
    watchdog_trips: int = 0
    disconnects: int = 0
    resets: int = 0
    start_ns: int = 0
    newest_row: int = 0
    elapsed_s: float = 0.0
    latched: int = 0
    tripped: int = 0
    tripped_before_disconnect: int = 0
    connected: int = 1
    paused: int = 0
    reason: int = 0
    over: int = 0
    got: int = 0
    __repr__ = short_repr


@dataclass(frozen=True)
class LinkCounts:
    """What came over all links of a session."""

    samples: int = 0
    crc_errors: int = 0
    sequence_gaps: int = 0
    unsent: int = 0
    saturated: int = 0
    device_error: int = 0


class Loop(Protocol):
    """Keep the time of a session, in C on this machine or on a board that renders by itself."""

    no_sample_advice: str

    def start(self, device: "OpenedDevice") -> None: ...
    def attach(self, device: "OpenedDevice") -> None: ...
    def ask_stop(self) -> None: ...
    def sense(self, measured_n: float) -> None: ...
    def pause(self, paused: bool) -> None: ...
    def reset(self) -> None: ...
    def get_status(self) -> LoopState: ...
    def counts(self) -> LinkCounts: ...
    def drain(self) -> "LoopRows": ...
    def flight(self, seconds: float) -> "LoopRows": ...
    def join(self) -> None: ...
    def scheduler(self) -> str: ...
    def refused(self) -> str: ...
