"""What a press keeps of the loop's rows: positions and measured forces, from the first call on."""

from collections.abc import Callable

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.host.native.loop_library import COLUMN, NONE, LoopRows, empty_rows


class PressRows:
    """Rows of one press of n commands; the force is the device's own.

    table: (rows, columns). unmeasured: a row has no force, but for the first `silent` ones.
    unlocated: a position is no number.
    """

    def __init__(
        self, n: int, on_samples: Callable[[Samples, Samples], None], silent: int = 0
    ) -> None:
        self._n, self._on_samples, self._silent = n, on_samples, silent
        self.table = empty_rows()
        self.unmeasured = self.unlocated = False

    @property
    def full(self) -> bool:
        return len(self.table) == self._n

    def column(self, name: str) -> Samples:
        """A column of the loop's rows, (rows,)."""
        return np.asarray(self.table[:, COLUMN[name]])

    def append(self, rows: LoopRows) -> None:
        """Take the loop's next rows."""
        rows = rows[(rows[:, COLUMN["call"]].astype(int) & NONE) == 0]
        rows = rows[: self._n - len(self.table)]
        position_m, force_n = rows[:, COLUMN["position_m"]], rows[:, COLUMN["measured_n"]]
        measured_n = force_n[max(0, self._silent - len(self.table)) :]
        self.unmeasured |= bool(np.isnan(measured_n).any())
        self.unlocated |= not np.isfinite(position_m).all()
        # An infinite force is beyond the limit: the loop has stopped.
        if self.unlocated or not np.isfinite(measured_n).all():
            return
        if len(rows):
            self.table = np.concatenate((self.table, rows))
            self._on_samples(position_m, force_n)
