"""Links of the Python loop: what one is, and a C link as one."""

import select
import time
from typing import Any, Protocol

from springpot.host.session.loop import LinkCounts

GONE, TRIPPED, ENDED = -1, -2, -3  # SP_LINK_ of sp_link.h


class PythonLink(Protocol):
    """A link without C: see sp_link.h for what its methods return."""

    position_m: float
    velocity_mps: float
    measured_n: float
    arrived_s: float
    samples: int
    crc_errors: int
    sequence_gaps: int
    unsent: int
    device_error: int
    ready: int
    made: bool  # a sample for every period, however late it is

    def listen(self, until_s: float) -> int:
        """Wait for the first sample until a time of time.monotonic; what read returns."""
        ...

    def write(self, force_n: float) -> int:
        """Send a force."""
        ...

    def reset(self) -> None:
        """Ask a device that tripped to take forces again."""
        ...


class CLink:
    """A C link with the methods of a Python one."""

    def __init__(self, link: Any, ffi: Any) -> None:
        self._link = link
        self._motion = ffi.new("sp_motion *")

    def __getattr__(self, name: str) -> Any:
        of_link = name == "ready" or name in LinkCounts.__dataclass_fields__
        return getattr(self._link if of_link else self._motion, name)

    @property
    def made(self) -> bool:
        """Whether there is a sample for every period, however late it is."""
        return bool(self._link.fd < 0)

    @property
    def arrived_s(self) -> float:
        """When the newest sample came, s of time.monotonic."""
        return float(self._motion.arrived_ns) * 1e-9

    def listen(self, until_s: float) -> int:
        """Wait for the first sample."""
        link = self._link
        while True:
            if link.fd >= 0:
                select.select([link.fd], [], [], max(0.0, until_s - time.monotonic()))
            elif (left := until_s - time.monotonic()) > 0:
                time.sleep(left)
            count = int(link.read(link, time.monotonic_ns(), self._motion, 1))
            if count or time.monotonic() >= until_s:
                return count

    def write(self, force_n: float) -> int:
        """Send a force."""
        return int(self._link.write(self._link, time.monotonic_ns(), force_n))

    def reset(self) -> None:
        """Ask a device that tripped to take forces again."""
        self._link.reset(self._link, time.monotonic_ns())
