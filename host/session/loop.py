"""Settings, state and counters of a loop."""

from dataclasses import dataclass

from springpot.codegen.messages import short_repr


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
