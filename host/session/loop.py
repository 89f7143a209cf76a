"""The loop as a session sees it: what keeps the time, its settings and its counters."""

from dataclasses import dataclass
from typing import Protocol

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
    """What keeps the time of a session: the C thread, or a board that renders by itself."""

    name: str
    no_sample_advice: str  # what to do where none ever came

    def start(self, device: OpenedDevice) -> None:
        """Begin ticking on an opened device."""
        ...

    def attach(self, device: OpenedDevice) -> None:
        """Go on with a device that came back."""
        ...

    def ask_stop(self) -> None:
        """End with zero force."""
        ...

    def sense(self, measured_n: float) -> None:
        """A sensor beside the device measured this, just now; from any thread."""
        ...

    def pause(self, paused: bool) -> None:
        """Zero force, and no calls until it is resumed."""
        ...

    def reset(self) -> None:
        """Reset the scene, and a device that tripped."""
        ...

    def get_status(self) -> LoopState:
        """Counters and flags."""
        ...

    def counts(self) -> LinkCounts:
        """Counters of the links."""
        ...

    def drain(self) -> LoopRows:
        """Rows since the last call."""
        ...

    def flight(self, seconds: float) -> LoopRows:
        """The last rows again, after the end."""
        ...

    def join(self) -> None:
        """Wait for the end."""
        ...

    def scheduler(self) -> str:
        """Who keeps the time, and what the system granted for it."""
        ...

    def refused(self) -> str:
        """What the system refused of it, and what to do; empty where nothing."""
        ...
