"""What a press keeps of the loop's rows: positions and measured forces, from the first call on."""

from collections.abc import Callable

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.host.native.loop_library import COLUMN, NONE, LoopRows


class PressRows:
    """Rows of one press; the force is the device's own.

    unmeasured: a row has no force. unlocated: a position is no number.
    """

    def __init__(self, n: int, on_samples: Callable[[Samples, Samples], None]) -> None:
        self._n, self._on_samples = n, on_samples
        self.position_m, self.force_n = np.empty(0), np.empty(0)
        self.unmeasured = self.unlocated = False

    @property
    def full(self) -> bool:
        return len(self.position_m) == self._n

    def append(self, rows: LoopRows) -> None:
        """Take the loop's next rows."""
        rows = rows[(rows[:, COLUMN["call"]].astype(int) & NONE) == 0]
        rows = rows[: self._n - len(self.position_m)]
        position_m, force_n = rows[:, COLUMN["position_m"]], rows[:, COLUMN["measured_n"]]
        self.unmeasured |= bool(np.isnan(force_n).any())
        self.unlocated |= not np.isfinite(position_m).all()
        # An infinite force is beyond the limit: the loop has stopped.
        if self.unlocated or not np.isfinite(force_n).all():
            return
        if len(rows):
            self.position_m = np.concatenate((self.position_m, position_m))
            self.force_n = np.concatenate((self.force_n, force_n))
            self._on_samples(position_m, force_n)
