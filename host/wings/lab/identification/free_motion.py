"""The motion of a free device as it is fitted: rows of the loop, cut and turned."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot import DeviceError
from springpot.basics import Samples
from springpot.loop import COLUMN, IDLE, NONE, LoopRows

_MAX_MISSING = 0.05


@dataclass(frozen=True)
class FreeMotion:
    """One run, a value a tick, each (n,).

    force_n: sent at the end of a tick, positive where it raises the position. fresh: whether the
    tick had a sample of its own; elsewhere position_m is a line between neighbours.
    """

    position_m: Samples
    velocity_mps: Samples
    force_n: Samples
    fresh: NDArray[np.bool_]
    dt_s: float


def unlocated(url: str) -> DeviceError:
    """Return the refusal of a device whose position is no number."""
    return DeviceError(
        f"{url}: sent a position that is no number, force zero, stopped: check its position sensor"
    )


def free_motion(rows: LoopRows, sign: int, dt_s: float, url: str) -> FreeMotion:
    """Take the rows of a run. sign: 1 where a positive force pushes the tool out.

    Raises DeviceError where more than 5 % of the ticks had no sample, or one was no number.
    """
    calls = rows[:, COLUMN["call"]].astype(int)
    fresh = (calls & (IDLE | NONE)) == 0
    position_m = rows[:, COLUMN["position_m"]]
    missing = 1 - fresh.mean() if len(rows) else 1.0
    if missing > _MAX_MISSING:
        raise DeviceError(
            f"{url}: {100 * missing:.0f} % of the ticks had no sample, 5 % are taken: set the "
            "device to the rate of the test, check the cable, and end other programs"
        )
    if not np.isfinite(position_m[fresh]).all():
        raise unlocated(url)
    ticks = np.arange(len(rows))
    return FreeMotion(
        position_m=np.interp(ticks, ticks[fresh], position_m[fresh]),
        velocity_mps=rows[:, COLUMN["velocity_mps"]],
        force_n=-sign * rows[:, COLUMN["sent_n"]],
        fresh=fresh,
        dt_s=dt_s,
    )
