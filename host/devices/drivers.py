"""Drivers: what each says of its addresses, those that springpot brings, and who opens a device."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path

from springpot.codegen.entry_points import blaming, registered
from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.messages import short_repr
from springpot.host.devices.device import DeviceRequirements, OpenedDevice
from springpot.host.devices.url import Address, parse_address


@dataclass(frozen=True)
class Driver:
    """One scheme of device addresses.

    example: addresses as messages show them. opens: "module:name" of a function or class, or
    itself, called with (Address, DeviceRequirements), that raises DeviceError or UsageError and
    returns an OpenedDevice. virtual: no hardware, nothing that a tool could touch. on_bus: an
    interface stands before the place, odrive://INTERFACE/CHANNEL. has_default: the place may be
    left out. echoes: the force that it measures is its own command. holds_weight: it takes [device]
    weight_n. own_frame: its position and force have one frame, so [device] force_sign has no
    meaning. links: C files of its
    link if they are not springpot's, each of which declares what Python calls between "springpot
    declarations begin" and "end". place: in lists.
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

    def __post_init__(self) -> None:
        """Raise TypeError for links that are no tuple; of a text each letter would be a file."""
        if not isinstance(self.links, tuple):
            raise TypeError("links: give a tuple of paths, (Path(...),)")

    def function(self) -> Callable[[Address, DeviceRequirements], OpenedDevice]:
        """Return what `opens` names, loaded."""
        if not isinstance(self.opens, str):
            return self.opens
        module, _, name = self.opens.partition(":")
        found: Callable[[Address, DeviceRequirements], OpenedDevice] = getattr(
            import_module(module), name
        )
        return found


@cache
def drivers() -> dict[str, Driver]:
    """Return the driver of each scheme: entry points of the group springpot.devices."""
    return registered("devices", Driver)


_HERE = "springpot.host.devices"
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
    """Take a device's URL apart.

    Raises DeviceError for a scheme that no driver serves, UsageError for a URL without its place.
    """
    table = drivers()
    return parse_address(
        url,
        {scheme: driver.example for scheme, driver in table.items()},
        "device",
        [scheme for scheme, driver in table.items() if driver.on_bus],
        [scheme for scheme, driver in table.items() if driver.has_default],
    )


def driver_of(url: str) -> Driver:
    """Return the driver of a device's URL. Raises as `parse_device`."""
    return drivers()[parse_device(url).scheme]


def open_device(url: str, requirements: DeviceRequirements) -> OpenedDevice:
    """Open, check and start a device; its motor gives no force yet.

    Raises UsageError for a wrong URL, DeviceError with one line for whatever else is wrong.
    """
    driver, address = driver_of(url), parse_device(url)
    if requirements.weight_n and not (driver.holds_weight or driver.virtual):
        able = ", ".join(f"{name}://" for name, one in drivers().items() if one.holds_weight)
        raise UsageError(
            f"{url}: only {able} devices hold a handle's weight up: leave [device] weight_n out"
        )
    if requirements.force_sign == -1 and driver.own_frame:
        raise UsageError(
            f"{url}: its position and force have one frame: leave [device] force_sign out"
        )
    with blaming(url, driver.opens, DeviceError):
        opened = driver.function()(address, requirements)
        if OpenedDevice not in type(opened).__mro__:
            raise TypeError(
                f"{type(opened).__name__} inherits neither OpenedDevice nor VirtualDevice"
            )
        return opened
