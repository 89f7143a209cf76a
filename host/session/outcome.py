"""A loop's settings, state and counts; the time it had, and in words what the C noted."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen import notes as notes_of
from springpot.codegen.arrays import Flags
from springpot.codegen.messages import short_repr
from springpot.host.native.c_library import Stop

BY_USER = "stopped by the user"
_WORDS = {
    "held": "no sample: the last one was held",
    "resync": "restarted without earlier samples, as at the start of a recording",
    "outside": "beyond what was recorded",
    "clamped": "force kept within its limits",
    "ramped": "force rising after a start or a silence",
    "latched": "watchdog: no force until a reset",
    "limited": "force held back: faster than a touch",
}
NOTE_NAMES: dict[int, str] = {getattr(notes_of, name.upper()): name for name in _WORDS}
NOTE_WORDS = {bit: _WORDS[name] for bit, name in NOTE_NAMES.items()}
UPPER, LOWER = "force kept at its upper limit", "force kept at its lower limit"


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


@dataclass(frozen=True)
class LoopState:
    """Result of sp_loop_get_status: counts since the start, flags, link counters."""

    ticks: int = 0
    late: int = 0
    stale: int = 0
    unused: int = 0
    ring_dropped: int = 0
    watchdog_trips: int = 0
    disconnects: int = 0
    resets: int = 0
    start_ns: int = 0
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
    """Counts over all links of a session."""

    samples: int = 0
    crc_errors: int = 0
    sequence_gaps: int = 0
    unsent: int = 0
    saturated: int = 0
    device_error: int = 0


def expected_ticks(state: LoopState, settings: LoopSettings) -> int:
    """Count the ticks that should have begun, by the computer's clock: one at the start."""
    if state.reason == Stop.TIME:
        return round(settings.seconds / settings.period_s)
    return int(state.elapsed_s / settings.period_s) + (state.elapsed_s > 0.0)


def hypervisor_steal_ms() -> float:
    """Time that the hypervisor took from this machine since it started, ms of all processors."""
    try:
        fields = Path("/proc/stat").read_text(encoding="utf-8").split("\n", 1)[0].split()
        return 10.0 * int(fields[8])
    except (OSError, IndexError, ValueError):
        return 0.0


def percentiles_us(seconds: Any) -> dict[str, float]:
    """Percentiles and the maximum of seconds (n,), us."""
    seconds = seconds if len(seconds) else np.zeros(1)
    shares = {"p50": 50, "p99": 99, "p999": 99.9, "max": 100}
    return {name: round(1e6 * float(np.percentile(seconds, q)), 3) for name, q in shares.items()}


def clamped_at_lower_limit(
    notes: NDArray[np.integer[Any]], force_n: NDArray[np.floating[Any]], min_n: float
) -> Flags:
    """Mark the ticks, (n,), whose force was held at the scene's lower limit, not at the upper.

    force_n: that left, N. min_n: the lower limit, N. A force that is on its way to a limit, for it
    may change by so much a tick, is between them: it falls to the lower one.
    """
    falls = np.diff(force_n, prepend=force_n[:1]) < 0.0
    low = (force_n <= min_n) | (falls & ((notes & notes_of.LIMITED) != 0))
    clamped: Flags = low & ((notes & notes_of.CLAMPED) != 0)
    return clamped


def note_sentence(counts: Mapping[str, int], low: int = 0, min_n: float = 0.0) -> str:
    """Say what the C noted. counts: ticks with each note, by its name.

    low: of those clamped, how many at the lower limit, min_n, N.
    """
    high = counts.get("clamped", 0) - low
    # At 0, where an object ends to push and does not pull, nothing is amiss.
    lower = f"{LOWER} of {min_n:.3g} N" if min_n else "at 0 N: the object does not pull"
    both = f"{low} {lower}; {high} {UPPER}" if low else UPPER
    all_words = {**_WORDS, "clamped": both if high else lower}
    parts = [
        f"{name} {counts[name]} ({words})" for name, words in all_words.items() if counts.get(name)
    ]
    return ", ".join(parts) or "none"
