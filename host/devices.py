"""Open the device of a URL: a dictionary of four schemes."""

from collections.abc import Callable

from springpot.host.device import Device, Wanted
from springpot.host.device_url import Address, parse_device
from springpot.host.made_devices import ReplayDevice, SimulatedDevice
from springpot.host.odrive_device import OdriveDevice
from springpot.host.serial_device import SerialDevice

_DRIVERS: dict[str, Callable[[Address, Wanted], Device]] = {
    "sim": SimulatedDevice,
    "replay": ReplayDevice,
    "serial": SerialDevice,
    "odrive": OdriveDevice,
}


def open_device(url: str, wanted: Wanted) -> Device:
    """Open, check and start a device; its motor gives no force yet.

    Raises UsageError for a wrong URL, DeviceError with one line for whatever else is wrong.
    """
    address = parse_device(url)
    return _DRIVERS[address.scheme](address, wanted)
