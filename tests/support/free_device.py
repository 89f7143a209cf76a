"""A simulated free device and the C that excites it, in lock step: as the loop would, no clock."""

from typing import Any

import numpy as np

from springpot.host.native.loop_library import COLUMN, IDLE, LoopRows, empty_rows
from springpot.host.wings.lab.free_device import FreeDevice, FreeDeviceTruth
from springpot.host.wings.lab.identification.excitation import (
    Excitation,
    MoveLimits,
    excite_step_functions,
)

LIMITS = MoveLimits(max_force_n=2.0, max_travel_m=0.02)


class LockStep:
    """Plays excitations on one device. missing: share of the ticks without a sample.

    sent_n, true_m: every force that was sent, and where the tool was, over all runs.
    """

    max_n: float | None = None

    def __init__(self, truth: FreeDeviceTruth, dt_s: float = 1e-3, missing: float = 0.0) -> None:
        self.device = FreeDevice(truth, dt_s)
        self.sent_n: list[float] = []
        self.true_m: list[float] = []
        self.rows: list[LoopRows] = []
        self._missing, self._chance = missing, np.random.default_rng(truth.seed)
        self._dt_s, self._command_n = dt_s, 0.0

    def __call__(self, excitation: Excitation, limits: MoveLimits) -> tuple[LoopRows, Any]:
        """Play one; rows until its end."""
        steps, excite = excite_step_functions(excitation, limits)
        c, force_n = steps.library.c, steps.library.ffi.new("double *")
        rows = empty_rows(len(excitation.command))
        seen = (0.0, 0.0)
        for count, row in enumerate(rows):
            new = self.device.step(self._command_n)
            if count and self._chance.random() < self._missing:
                row[COLUMN["call"]] = IDLE
                row[COLUMN["notes"]] = c.sp_excite_idle(excite, self._dt_s, force_n)
            else:
                seen = new
                row[COLUMN["notes"]] = c.sp_excite_step(excite, *seen, force_n)
            self._command_n = force_n[0]
            row[COLUMN["position_m"]], row[COLUMN["velocity_mps"]] = seen
            row[COLUMN["sent_n"]] = self._command_n
            self.sent_n.append(self._command_n)
            self.true_m.append(self.device.true_motion()[0])
        self.rows.append(rows[: excite.n])
        return self.rows[-1], excite


def random_truth(seed: int, **also: float) -> FreeDeviceTruth:
    """A device of the sizes that hands hold, of either sign; also: what is otherwise."""
    chance = np.random.default_rng(seed)
    usual = {
        "mass_kg": float(np.exp(chance.uniform(np.log(0.05), 0.0))),
        "viscous_nspm": chance.uniform(0.2, 8.0),
        "coulomb_n": chance.uniform(0.0, 0.5),
        "delay_s": chance.uniform(0.0, 0.005),
        "position_step_m": float(np.exp(chance.uniform(np.log(1e-6), np.log(50e-6)))),
        "position_noise_m": chance.uniform(0.0, 5e-6),
        "sign": float(chance.choice([-1.0, 1.0])),
    }
    return FreeDeviceTruth(**(usual | also), seed=seed)
