"""A simulated free device and the C that excites it, in lock step: as the loop would, no clock."""

from typing import Any

import numpy as np

from springpot.host.identification.excitation import Excitation, MoveLimits, excite_step_functions
from springpot.host.native.loop_library import COLUMN, IDLE, LoopRows, empty_rows
from springpot.host.simulation.free_device import FreeDevice, FreeDeviceTruth


class LockStep:
    """Runs excitations on one device; every row of every run is kept in `runs`."""

    max_n: float | None = None

    def __init__(self, truth: FreeDeviceTruth, dt_s: float = 1e-3) -> None:
        self.device = FreeDevice(truth, dt_s)
        self.runs: list[LoopRows] = []
        self.truth_m: list[float] = []
        self._command_n = 0.0

    def __call__(self, excitation: Excitation, limits: MoveLimits) -> tuple[LoopRows, Any]:
        steps, excite = excite_step_functions(excitation, limits)
        c, force_n = steps.library.c, steps.library.ffi.new("double *")
        rows = empty_rows(len(excitation.command))
        for row in rows:
            position_m, velocity_mps = self.device.step(self._command_n)
            notes = c.sp_excite_step(excite, position_m, velocity_mps, force_n)
            self._command_n = force_n[0]
            row[COLUMN["position_m"]], row[COLUMN["velocity_mps"]] = position_m, velocity_mps
            row[COLUMN["sent_n"]], row[COLUMN["notes"]] = self._command_n, notes
            self.truth_m.append(self.device.true_motion()[0])
            if excite.at == excite.n:
                break
        self.runs.append(rows)
        return rows, excite
