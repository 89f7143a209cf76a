"""A force sensor: samples taken by a thread, each with its own time, on the host's clock."""

import math
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from springpot import DeviceError, SpringpotError
from springpot.basics import Samples

MIN_RATE_HZ = 400.0
_COUNT_S = 0.5  # in which the rate is measured


class ArrivalLine:
    """host time = offset + rate * stamp, of the samples that were under way for the least time.

    What delays a sample on its way only ever delays it, so that the clock's line lies below all
    arrivals: of such lines, the one that is nearest to them on average (Paxson 1998). It runs
    through two points of the lower hull, which grows with each sample.
    """

    def __init__(self) -> None:
        self._hull: list[tuple[float, float]] = []
        self._sum_s, self._count = 0.0, 0
        self._edge = 0

    def add(self, stamp_s: float, arrived_s: float) -> None:
        """Take a sample's own time and when it came, s. Stamps must increase."""
        hull = self._hull
        while len(hull) > 1 and not _turns_up(hull[-2], hull[-1], (stamp_s, arrived_s)):
            hull.pop()
        hull.append((stamp_s, arrived_s))
        self._sum_s += stamp_s
        self._count += 1

    def host_s(self, stamp_s: float) -> float:
        """Return when a sample of this stamp would have come, had nothing held it back, s."""
        hull = self._hull
        if len(hull) < 2:
            return hull[0][1] + stamp_s - hull[0][0] if hull else math.nan
        mean_s = self._sum_s / self._count
        at = min(self._edge, len(hull) - 2)
        while at > 0 and hull[at][0] > mean_s:
            at -= 1
        while at < len(hull) - 2 and hull[at + 1][0] <= mean_s:
            at += 1
        self._edge = at
        (begin, begin_s), (end, end_s) = hull[at], hull[at + 1]
        return begin_s + (end_s - begin_s) / (end - begin) * (stamp_s - begin)


def _turns_up(
    first: tuple[float, float], second: tuple[float, float], third: tuple[float, float]
) -> bool:
    before = (second[1] - first[1]) * (third[0] - second[0])
    return before < (third[1] - second[1]) * (second[0] - first[0])


@dataclass(frozen=True)
class Stamped:
    """One sample: its own time, s of the sensor's clock, and the force, N."""

    stamp_s: float
    force_n: float


class SensorSource(Protocol):
    """Where samples come from."""

    def read(self) -> Sequence[Stamped]:
        """Return new samples, oldest first; waits up to 50 ms for one. Raises DeviceError."""
        ...

    def close(self) -> None: ...


class ForceSensor:
    """Samples since the start, on the host's clock (of time.monotonic).

    on_force: called with each force as it comes, in the thread's time.
    """

    def __init__(self, url: str, source: SensorSource) -> None:
        self.url = url
        self.on_force: Callable[[float], None] = lambda _force_n: None
        self.error: SpringpotError | None = None
        self._source = source
        self._line = ArrivalLine()
        self._lock = threading.Lock()
        self._kept = np.empty((1024, 2))  # stamps, s, and forces, N; `_count` of them
        self._count = 0
        self._newest_s = -np.inf
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._take, daemon=True)
        self._thread.start()

    def require_rate(self) -> None:
        """Wait until its rate is known. Raises DeviceError where it is too low, or it failed."""
        begin_s, before = time.monotonic(), self._count
        self._over.wait(_COUNT_S)
        self.require_alive()
        rate_hz = (self._count - before) / (time.monotonic() - begin_s)
        if self._count == 0:
            raise DeviceError(
                f"{self.url}: no sample came in {_COUNT_S:g} s: check its power, the wiring, and "
                "the bus's bitrate and database"
            )
        if rate_hz < MIN_RATE_HZ:
            raise DeviceError(
                f"{self.url}: sends {rate_hz:.0f} samples a second, a recording at 1 kHz needs "
                f"{MIN_RATE_HZ:g}: between two of its samples a press changes by more than its "
                "noise (an HX711 board gives 80): take a faster one"
            )

    def require_alive(self) -> None:
        """Raise what ended the thread, where something did."""
        if self.error is not None:
            raise self.error

    def forget(self) -> None:
        """Drop the samples up to now; the clock's line is kept."""
        with self._lock:
            self._count = 0

    def samples(self) -> tuple[Samples, Samples]:
        """Return times on the host's clock, s, and forces, N, since `forget`; oldest first."""
        with self._lock:
            stamps_s, forces_n = self._kept[: self._count].T.copy()
            if not len(stamps_s):
                return stamps_s, forces_n
            first_s, last_s = (self._line.host_s(stamp) for stamp in stamps_s[[0, -1]])
        span_s = stamps_s[-1] - stamps_s[0]
        rate = (last_s - first_s) / span_s if span_s else 1.0
        return first_s + rate * (stamps_s - stamps_s[0]), forces_n

    def close(self) -> None:
        self._over.set()
        self._thread.join(1.0)
        self._source.close()

    def _take(self) -> None:
        try:
            while not self._over.is_set():
                self._keep(self._source.read(), time.monotonic())
        except SpringpotError as error:
            self.error = error
        except Exception as error:  # of a driver
            reason = " ".join(str(error).split())
            self.error = DeviceError(f"{self.url}: went away ({reason}): check cable and power")
        finally:
            self._over.set()

    def _keep(self, taken: Sequence[Stamped], now_s: float) -> None:
        with self._lock:
            for sample in taken:
                if sample.stamp_s == self._newest_s:
                    continue  # of a coarse clock
                if sample.stamp_s < self._newest_s:
                    raise DeviceError(
                        f"{self.url}: its time stamps went back: it restarted, or another sensor "
                        "sends under the same name: start again"
                    )
                self._newest_s = sample.stamp_s
                self._line.add(sample.stamp_s, now_s)
                if self._count == len(self._kept):
                    self._kept = np.concatenate((self._kept, np.empty_like(self._kept)))
                self._kept[self._count] = sample.stamp_s, sample.force_n
                self._count += 1
        if taken:
            self.on_force(taken[-1].force_n)
