"""Devices by URL: addresses taken apart, drivers, those that springpot brings, who opens one."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from pkgutil import resolve_name
from typing import TypeVar
from urllib.parse import parse_qsl, unquote, urlsplit

from springpot.codegen.entry_points import blame_package, load_entries
from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.messages import short_repr
from springpot.host.devices.device import DeviceRequirements, OpenedDevice

_HERE = "springpot.host.devices"
Word = TypeVar("Word", bound=str)


@dataclass(frozen=True)
class Address:
    """A device URL, taken apart.

    place: what follows the scheme; on a bus without the interface. settings: the query.
    """

    url: str
    scheme: str
    interface: str
    place: str
    settings: dict[str, str]
    __repr__ = short_repr

    def number(self, key: str, default: float, minimum: float, maximum: float) -> float:
        """Return a setting as a number. Raises UsageError outside minimum .. maximum."""
        text = self.settings.get(key)
        if text is None:
            return default
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not minimum <= value <= maximum:
            raise UsageError(
                f"{self.url}: {key}={text}: give a number between {minimum:.10g} and {maximum:.10g}"
            )
        return value

    def whole(self, key: str, default: int, minimum: int, maximum: int) -> int:
        """Return a setting as a whole number. Raises UsageError outside minimum .. maximum."""
        value = self.number(key, default, minimum, maximum)
        if value % 1.0:
            raise UsageError(f"{self.url}: {key}={value:g}: give a whole number")
        return int(value)

    def choice(self, key: str, known: Sequence[Word]) -> Word:
        """Return a setting that is one of some words, by default the first. Raises UsageError."""
        text = self.settings.get(key, known[0])
        for word in known:
            if word == text:
                return word
        raise UsageError(f"{self.url}: {key}={text}: give one of {', '.join(known)}")

    def require_known(self, known: tuple[str, ...]) -> None:
        """Raise UsageError for a setting that is not among the known ones."""
        for key in self.settings:
            if key not in known:
                use = f"use {', '.join(known)}" if known else "it has none"
                raise UsageError(f"{self.url}: no setting {key!r}: {use}")


@dataclass(frozen=True)
class Driver:
    """One scheme of device addresses.

    example: addresses as messages show them. opens: "module:name" of a function or class, or
    itself, called with (Address, DeviceRequirements), that raises DeviceError or UsageError and
    returns an OpenedDevice. virtual: no hardware, nothing that a tool could touch. on_bus: an
    interface stands before the place, odrive://INTERFACE/CHANNEL. has_default: the place may be
    left out. echoes: the force that it measures is its own command. holds_weight: it takes [device]
    weight_n. own_frame: its position and force have one frame, so [device] force_sign has no
    meaning. links: C files of its link if they are not springpot's, each of which declares what
    Python calls between "springpot declarations begin" and "end". place: in lists.
    """

    example: str
    opens: str | Callable[[Address, DeviceRequirements], OpenedDevice]
    virtual: bool = False
    on_bus: bool = False
    has_default: bool = False
    holds_weight: bool = False
    own_frame: bool = False
    echoes: bool = False
    links: tuple[Path, ...] = ()
    place: int = 100
    __repr__ = short_repr

    def function(self) -> Callable[[Address, DeviceRequirements], OpenedDevice]:
        """Return what `opens` names, loaded."""
        if not isinstance(self.opens, str):
            return self.opens
        opener: Callable[[Address, DeviceRequirements], OpenedDevice] = resolve_name(self.opens)
        return opener


@cache
def drivers() -> dict[str, Driver]:
    """Return the driver of each scheme: entry points of the group springpot.devices."""
    return load_entries("devices", Driver)


# Registered in pyproject.toml; each module is loaded when a device of it is opened: a simulated
# device needs no serial port.
SIM = Driver(
    "sim://OBJECT, for example sim://ecoflex-00-30?hand=mid",
    f"{_HERE}.virtual:SimulatedDevice", virtual=True, place=0,
)  # fmt: skip
REPLAY = Driver(
    "replay://FILE, a recording", f"{_HERE}.virtual:ReplayDevice", virtual=True, place=1
)


def parse_device(url: str) -> Address:
    """Take a URL apart.

    Raises DeviceError for a scheme that no driver serves, UsageError for a URL without its place.
    """
    table, parts = drivers(), urlsplit(url)
    driver = table.get(parts.scheme)
    if driver is None:
        what = repr(parts.scheme) if parts.scheme else "an address without a scheme"
        raise DeviceError(
            f"{url}: no driver for {what}: use "
            + "; ".join(known.example for known in table.values())
        )
    interface = parts.netloc if driver.on_bus else ""
    place = parts.path.removeprefix("/") if interface else parts.netloc + parts.path
    if (not place and not driver.has_default) or (driver.on_bus and not interface):
        raise UsageError(f"{url}: not complete: use {driver.example}")
    settings = dict(parse_qsl(parts.query, keep_blank_values=True))
    return Address(url, parts.scheme, interface, unquote(place), settings)


def find_driver(url: str) -> Driver:
    """Return the driver of a device's URL. Raises as `parse_device`."""
    return drivers()[parse_device(url).scheme]


def open_device(url: str, requirements: DeviceRequirements) -> OpenedDevice:
    """Open, check and start a device; its motor gives no force yet.

    Raises UsageError for a wrong URL, DeviceError with one line for whatever else is wrong.
    """
    driver, address = find_driver(url), parse_device(url)
    if requirements.weight_n and not (driver.holds_weight or driver.virtual):
        able = ", ".join(f"{name}://" for name, one in drivers().items() if one.holds_weight)
        raise UsageError(
            f"{url}: only {able} devices hold a handle's weight up: leave [device] weight_n out"
        )
    if requirements.force_sign == -1 and driver.own_frame:
        raise UsageError(
            f"{url}: its position and force have one frame: leave [device] force_sign out"
        )
    with blame_package(url, driver.opens, DeviceError):
        opened = driver.function()(address, requirements)
        if OpenedDevice not in type(opened).__mro__:  # a Protocol refuses isinstance
            raise TypeError(f"{type(opened).__name__} is no OpenedDevice and no VirtualDevice")
        return opened


SERIAL = Driver("serial:///dev/ttyACM0?baud=921600", f"{_HERE}.serial_device:SerialDevice", place=2)
ODRIVE = Driver(
    "odrive://slcan//dev/ttyACM0?node=0, odrive://socketcan/can0?node=0, or "
    "odrive://INTERFACE/CHANNEL?node=0 for another interface of python-can",
    f"{_HERE}.odrive_device:OdriveDevice", on_bus=True, echoes=True, place=3,
)  # fmt: skip
DHD = Driver(
    "dhd://, the first Force Dimension device, or dhd://1, the second",
    f"{_HERE}.dhd_device:DhdDevice",
    has_default=True, holds_weight=True, own_frame=True, place=4,
)  # fmt: skip
