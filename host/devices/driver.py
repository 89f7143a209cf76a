"""What a device's file says of itself: how its address looks, and who opens it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path

from springpot.codegen.entry_points import registered
from springpot.host.devices.device import DeviceRequirements, OpenedDevice
from springpot.host.devices.url import Address


@dataclass(frozen=True)
class Driver:
    """One scheme of device addresses.

    example: addresses as messages show them. opens: "module:name" of a function or class, or
    itself, called with (Address, DeviceRequirements), that raises DeviceError or UsageError and
    returns an OpenedDevice. virtual: no hardware, nothing that a tool could touch. on_bus: an
    interface stands before the place, odrive://INTERFACE/CHANNEL. has_default: the place may be
    left out. echoes: the force that it measures is its own command. holds_weight: it takes
    [device] weight_n. own_frame: its position and force have one frame, so [device] force_sign
    has no meaning. links: C sources of its link if they are not springpot's
    (host/native/loop_library.py says how they declare it). place: in lists.
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
