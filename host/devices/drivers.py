"""Open the device of a URL: a dictionary of schemes."""

from collections.abc import Callable

from springpot.codegen.errors import UsageError
from springpot.host.devices.device import DeviceRequirements, OpenedDevice
from springpot.host.devices.dhd_device import DhdDevice
from springpot.host.devices.odrive_device import OdriveDevice
from springpot.host.devices.serial_device import SerialDevice
from springpot.host.devices.url import Address, parse_device
from springpot.host.devices.virtual import ReplayDevice, simulated_device

_DRIVERS: dict[str, Callable[[Address, DeviceRequirements], OpenedDevice]] = {
    "sim": simulated_device,
    "replay": ReplayDevice,
    "serial": SerialDevice,
    "odrive": OdriveDevice,
    "dhd": DhdDevice,
}
_SIMPLE = ("serial", "odrive")  # one axis, of which springpot does not know the way down


def open_device(url: str, requirements: DeviceRequirements) -> OpenedDevice:
    """Open, check and start a device; its motor gives no force yet.

    Raises UsageError for a wrong URL, DeviceError with one line for whatever else is wrong.
    """
    address = parse_device(url)
    if requirements.weight_n and address.scheme in _SIMPLE:
        raise UsageError(
            f"{url}: only dhd:// devices hold a handle's weight up: leave [device] weight_n out"
        )
    if requirements.force_sign == -1 and address.scheme == "dhd":
        raise UsageError(
            f"{url}: its position and force have one frame: leave [device] force_sign out"
        )
    return _DRIVERS[address.scheme](address, requirements)
