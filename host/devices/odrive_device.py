"""ODrive motor drives on the kernel's CAN, or on an interface of python-can such as slcan."""

import contextlib
import math
import sys
import time
from dataclasses import dataclass

from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.types import CData
from springpot.host.devices.can_bus import STUFFED_BITS, CanBus
from springpot.host.devices.device import (
    FORCE_ZERO,
    DeviceRequirements,
    OpenedDevice,
    require_sample_rate,
    round_down,
    weakness_sentence,
)
from springpot.host.devices.drivers import Address
from springpot.host.devices.odrive import ENCODER, Drive, DriveLimits, identifier
from springpot.host.devices.serial_port import require_fast_adapter, require_port

BITRATE = 1_000_000
MAX_RATE_HZ = 1000  # of cyclic messages: their interval is a whole number of ms
_RATE_KEYS = {"0.5": "encoder_rate_ms", "0.6": "encoder_msg_rate_ms"}
_HAND_MPS = 2.0
_SPARE_TURNS_PER_S = 20.0
_CURRENT = 1.05  # of the current for the greatest torque: a torque constant has about two digits
_KEYS = ("node", "bitrate", "port", "m_per_turn", "sign", "zero_turns", "max_torque_nm",
         "nm_per_a", "surface_mm")  # fmt: skip


@dataclass(frozen=True)
class Transmission:
    """From turns and Nm of the motor to m and N of the tool; nm_per_a: its torque constant."""

    m_per_turn: float
    sign: float
    zero_turns: float
    surface_m: float
    max_torque_nm: float
    nm_per_a: float

    @property
    def max_n(self) -> float:
        return self.max_torque_nm * 2 * math.pi / self.m_per_turn

    @property
    def limits(self) -> DriveLimits:
        """Limits that let every force through at every speed of a hand.

        In torque control a drive gives no more torque than vel_gain times what its velocity
        limit leaves: 1/6 Nm for each turn/s by default, less where a small motor was tuned.
        """
        spare = 6 * self.max_torque_nm + _SPARE_TURNS_PER_S
        return DriveLimits(
            _HAND_MPS / self.m_per_turn + spare, _CURRENT * self.max_torque_nm / self.nm_per_a
        )


class OdriveDevice(OpenedDevice):
    """One axis: opened, its watchdog proved, in torque control."""

    unreached = FORCE_ZERO  # by its own watchdog, which was proved

    def __init__(self, address: Address, requirements: DeviceRequirements) -> None:
        """Open and arm it. Raises UsageError for a missing transmission, DeviceError otherwise."""
        _require_linux(address.url)
        address.require_known(_KEYS)
        self.address = address
        self.node = address.whole("node", 0, 0, 63)
        bitrate = address.whole("bitrate", BITRATE, 10_000, 1_000_000)
        self.transmission = _transmission(address, requirements)
        require_fast_bus(address.url, bitrate, requirements.rate_hz)
        if address.interface == "slcan":
            require_port(address.place)
            require_fast_adapter(address.place, requirements.rate_hz)
        self.bus = CanBus(address, bitrate)
        self.drive = Drive(self.bus, self.node, address.url, self.transmission.limits)
        self._rate_hz = requirements.rate_hz
        self._memory: CData = None
        try:
            self.drive.make_ready()
            require_sample_rate(
                address.url, requirements.rate_hz, self._estimates_until, self.rate_advice
            )
        except BaseException:
            self.bus.close()
            raise

    @property
    def rate_advice(self) -> str:
        """Say how to make the drive send estimates at the scene's rate."""
        if self._rate_hz > MAX_RATE_HZ:
            return f"a drive sends at most {MAX_RATE_HZ} a second: set runtime.rate_hz"
        key = _RATE_KEYS[self.drive.family]
        return (
            f"set `odrv0.axis0.config.can.{key} = {int(1000 / self._rate_hz)}` and save, or render "
            "a scene of its rate ([runtime] rate_hz, where the model allows it)"
        )

    @property
    def failure(self) -> str:
        return self.bus.failure

    def link(self, library: CLibrary) -> CData:
        """Make the link by which the loop in C speaks to the drive."""
        train = self.transmission
        settings = library.ffi.new(
            "sp_odrive *",
            {
                "node": self.node,
                "with_torque": int(self.drive.family == "0.6"),  # it alone sends its torque
                **{name: value for name, value in vars(train).items() if name != "nm_per_a"},
                "max_turns_per_s": train.limits.turns_per_s,
                "max_current_a": train.limits.current_a,
            },
        )
        self._memory = library.memory(library.c.sp_link_odrive_size())
        return library.c.sp_link_odrive_init(self._memory, self.bus.fd, settings)

    def _estimates_until(self, until_s: float) -> int:
        """Count the estimates that come; those that waited until now are not counted."""
        while self.bus.receive(time.perf_counter()) is not None:
            pass
        estimates = 0
        while (frame := self.bus.receive(until_s)) is not None:
            estimates += frame[0] == identifier(self.node, ENCODER)
        return estimates

    def stop(self) -> None:
        with contextlib.suppress(DeviceError):  # gone: its watchdog does it
            self.drive.rest()

    def close(self) -> None:
        self.bus.close()


def _require_linux(url: str) -> None:
    if sys.platform != "linux":
        raise DeviceError(f"{url}: an ODrive needs the CAN of Linux: render on Linux")


def require_fast_bus(url: str, bitrate: int, rate_hz: float) -> None:
    """Raise DeviceError where position and torque frames of each tick do not fit."""
    needed = 2 * STUFFED_BITS * rate_hz
    if needed > bitrate:
        raise DeviceError(
            f"{url}: {bitrate / 1e3:g} kbit/s carry {bitrate / (2 * STUFFED_BITS):.0f} exchanges "
            f"a second, {rate_hz:g} Hz need {needed / 1e3:.0f} kbit/s: set drive and ?bitrate= to "
            "1000000, or lower runtime.rate_hz"
        )


def _transmission(address: Address, requirements: DeviceRequirements) -> Transmission:
    """Return how turns become metres and torque becomes force, of the URL or the scene.

    Raises UsageError for what is missing.
    """
    stated = {
        key: address.number(key, getattr(requirements, key) or 0.0, 0, most)
        for key, most in (("m_per_turn", 100), ("max_torque_nm", 1e4), ("nm_per_a", 1e4))
    }
    for key, value in stated.items():
        if not value > 0:
            raise UsageError(
                f"{address.url}: {key} is not known: set device.{key} in the scene, or ?{key}="
            )
    sign = address.number("sign", requirements.sign, -1, 1)
    if sign not in (-1, 1):
        raise UsageError(f"{address.url}: sign={sign:g}: give 1 or -1")
    transmission = Transmission(
        **stated,
        sign=sign,
        zero_turns=address.number("zero_turns", requirements.zero_turns, -1e6, 1e6),
        surface_m=address.number("surface_mm", 1e3 * requirements.surface_m, -1e5, 1e5) / 1e3,
    )
    if transmission.max_n < requirements.max_n * (1 - 1e-6):
        gives = f"{transmission.max_torque_nm:g} Nm give {round_down(transmission.max_n)} N"
        other = ", or device.max_torque_nm"
        raise weakness_sentence(address.url, gives, requirements, transmission.max_n, other)
    return transmission
