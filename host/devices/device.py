"""What every opened device offers to a session."""

import math
import time
from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from springpot.codegen.errors import DeviceError
from springpot.codegen.messages import short_repr
from springpot.codegen.scene import Device
from springpot.codegen.types import CData

if TYPE_CHECKING:
    from springpot.codegen.native.c_library import CLibrary


RECONNECT_S = 10.0  # a device that was unplugged is waited for so long
FORCE_ZERO = "force zero"  # its own watchdog, or it is no hardware
ZERO_S = 0.2  # without a host, a device's own watchdog ends its force within so long
_PROOFS = 3
_ENOUGH = 0.9  # of the wanted samples: below it, they are no longer losses
# A hundred periods tell a tenth from what a few losses take; again, as a busy machine holds back.
_PERIODS, _MIN_S, _MAX_S, _TIMES = 100, 0.1, 2.0, 3


def round_down(value: float) -> str:
    """Three digits of a limit, rounded towards zero: what they say is within it."""
    if not value > 0:
        return "0"
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return f"{math.floor(value / step * (1 + 1e-12)) * step:g}"


@dataclass(frozen=True)
class DeviceRequirements:
    """Requirements of a session on a device.

    presses: the loop drives the tool into an object, to record it. senses: it is read only.
    examined: nothing is rendered.
    max_n: of the scene's force.
    m_per_turn .. nm_per_a: the transmission and torque constant of a motor drive.
    effector_mass_kg, weight_n: of the handle; its mass is compensated, its weight held up.
    """

    rate_hz: float
    watchdog_s: float
    max_n: float
    presses: bool = False
    senses: bool = False
    examined: bool = False
    surface_m: float = 0.0
    m_per_turn: float | None = None
    sign: int = 1
    force_sign: int = 1
    zero_turns: float = 0.0
    max_torque_nm: float | None = None
    nm_per_a: float | None = None
    effector_mass_kg: float | None = None
    weight_n: float = 0.0
    __repr__ = short_repr


def requirements_from_keys(keys: Device, **requirements: CData) -> DeviceRequirements:
    """Join the keys of the scene's [device] with what the session asks besides."""
    known = DeviceRequirements.__dataclass_fields__
    stated = {name: value for name, value in vars(keys).items() if name in known}
    return DeviceRequirements(surface_m=1e-3 * keys.surface_mm, **stated, **requirements)


def weakness_sentence(
    url: str, gives: str, required: DeviceRequirements, max_n: float, other: str = ""
) -> DeviceError:
    """Return the refusal of a device that gives less force, max_n, than is required.

    gives: that in words. other: what else would help.
    """
    limit = round_down(max_n)
    return DeviceError(
        f"{url}: {gives} and the scene up to {required.max_n:g} N: set guard.max_force_n = "
        f"{limit}{other}"
    )


class OpenedDevice(Protocol):
    """A device that was opened, checked and started: it sends samples and takes forces.

    comes_back: it can be unplugged and plugged in again. A driver's class inherits what harms
    nobody if it is not stated.
    """

    comes_back: bool = True

    @property
    @abstractmethod
    def unreached(self) -> str:
        """Say what the device's force does once this host cannot reach it; every driver has to."""
        ...

    @property
    def rate_advice(self) -> str:
        """Advice if the device sends fewer samples than the scene wants."""
        return ""

    @property
    def failure(self) -> str:
        """Reason why the device is gone or off, if a lower layer gives one; else empty."""
        return ""

    @abstractmethod
    def link(self, library: "CLibrary") -> CData:
        """Return the C link (sp_link *); from then on only the loop reads and writes."""
        ...

    @abstractmethod
    def stop(self) -> None:
        """After the loop: no force, acknowledged where the device can. Raises nothing."""
        ...

    @abstractmethod
    def close(self) -> None:
        """Let the device go: the last call."""


class VirtualDevice(OpenedDevice):
    """Base of devices without hardware, which need only `__init__` and `link`."""

    comes_back = False
    unreached = FORCE_ZERO

    def stop(self) -> None:
        """End nothing: there is no motor."""

    def close(self) -> None:
        """Close nothing."""


def proved_watchdog_s(silence_s: Callable[[], float]) -> float:
    """Least time, s, in which a device ended its force in up to three silences; inf where never.

    silence_s: makes one, and returns how long that took. Three, for a message may be lost, or late.
    """
    found_s = math.inf
    for _ in range(_PROOFS):
        found_s = min(found_s, silence_s())
        if found_s <= ZERO_S or math.isinf(found_s):
            break
    return found_s


def require_sample_rate(
    url: str, rate_hz: float, count: Callable[[float], int], advice: str
) -> None:
    """Raise DeviceError where a device sends less than 90 % of rate_hz samples a second.

    count: how many come until a time of time.perf_counter. advice: what mends it. A device that
    sends none is not refused here: the session waits for it, and says so.
    """
    window_s = min(max(_PERIODS / rate_hz, _MIN_S), _MAX_S)
    most_hz = 0.0
    for _ in range(_TIMES):
        begin_s = time.perf_counter()
        samples = count(begin_s + window_s)
        most_hz = max(most_hz, samples / (time.perf_counter() - begin_s))
        if most_hz >= _ENOUGH * rate_hz:
            return
    if most_hz:
        raise DeviceError(
            f"{url}: sends {most_hz:.3g} samples a second, the scene runs at {rate_hz:g} Hz: "
            f"{advice}"
        )
