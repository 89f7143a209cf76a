"""The log of a session: a recording with a row for each tick, and all that the scene was given.

Position and force are what the tool did and what was sent to the device; the channels beside them
hold every call in order, bit for bit, so that `springpot validate` can make each again.
"""

from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.types import JsonMapping
from springpot.host.native.c_library import COLUMN, COLUMNS, INPUT, LoopRows
from springpot.trainer.recordings.journal import JournalWriter
from springpot.trainer.recordings.recording import Zero

_KEPT = tuple(name for name in COLUMNS if name not in ("position_m", "sent_n"))
CHANNELS = (INPUT, *_KEPT)


class SessionLog:
    """Takes the rows of a loop as they come.

    measured: log the load cell as the force.
    """

    def __init__(
        self,
        file: Path,
        dt_s: float,
        source: str,
        details: JsonMapping,
        *,
        zero: Zero = "none",
        measured: bool = False,
        place_m: tuple[float, float] | None = None,
    ) -> None:
        self._kept = [COLUMN[name] for name in ("position_m", *_KEPT)]
        self.file = file
        self._journal = JournalWriter(
            file, file.stem, dt_s, source, details, zero=zero, channels=CHANNELS,
            place_m=place_m,
        )  # fmt: skip
        self._force = COLUMN["measured_n" if measured else "sent_n"]
        self._last = np.zeros(2)
        self.rows = 0

    def append(self, rows: LoopRows) -> None:
        """Take the next rows. Raises DeviceError where the disk is full."""
        if not len(rows):
            return
        position_m = self._finite(rows[:, COLUMN["position_m"]], 0)
        force_n = self._finite(rows[:, self._force], 1)
        self._journal.append(position_m, force_n, rows[:, self._kept])
        self.rows += len(rows)

    def finish(self, details: JsonMapping) -> None:
        """Make a recording of the journal. Raises DeviceError where there is no room."""
        try:
            self._journal.finish(details)
        except DataError:
            raise DataError(f"{self.file}: the session ended before its first samples") from None

    @property
    def has_space(self) -> bool:
        """Whether everything until now could be written."""
        return not self._journal.full

    def discard(self) -> None:
        """Leave nothing behind: the session never began."""
        self._journal.discard()

    def __enter__(self) -> "SessionLog":
        self._journal.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        self._journal.__exit__(*error)

    def _finite(self, values: Samples, channel: int) -> Samples:
        """Hold the last finite value where there is none: a recording has no holes."""
        held = np.concatenate((self._last[channel : channel + 1], values))
        good = np.maximum.accumulate(np.where(np.isfinite(held), np.arange(len(held)), 0))
        result = held[good][1:]
        self._last[channel] = result[-1]
        return result
