"""A device's samples are counted before its motor is armed: at another rate they are no motion."""

import time
from collections.abc import Callable

from springpot.codegen.errors import DeviceError

_ENOUGH = 0.9  # of the wanted samples: below it, they are no longer losses
# A hundred periods tell a tenth from what a few losses take; again, as a busy machine holds back.
_PERIODS, _MIN_S, _MAX_S, _TIMES = 100, 0.1, 2.0, 3


def require_sample_rate(
    url: str, rate_hz: float, count: Callable[[float], int], advice: str
) -> None:
    """Raise DeviceError where a device sends less than 90 % of rate_hz samples a second.

    count: how many come until a time of time.monotonic. advice: what mends it. A device that sends
    none is not refused here: the session waits for it, and says so.
    """
    window_s = min(max(_PERIODS / rate_hz, _MIN_S), _MAX_S)
    most_hz = 0.0
    for _ in range(_TIMES):
        begin_s = time.monotonic()
        samples = count(begin_s + window_s)
        most_hz = max(most_hz, samples / (time.monotonic() - begin_s))
        if most_hz >= _ENOUGH * rate_hz:
            return
    if most_hz:
        raise DeviceError(
            f"{url}: sends {most_hz:.3g} samples a second, the scene runs at {rate_hz:g} Hz: "
            f"{advice}"
        )
