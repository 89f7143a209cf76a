"""Open the device of a URL: a dictionary of schemes."""

from importlib import import_module

from springpot.codegen.errors import UsageError
from springpot.host.devices.device import DeviceRequirements, OpenedDevice
from springpot.host.devices.url import parse_device

# Each is loaded when it is opened: a simulated device needs no serial port.
_DRIVERS = {
    "sim": "virtual.simulated_device",
    "replay": "virtual.ReplayDevice",
    "serial": "serial_device.SerialDevice",
    "odrive": "odrive_device.OdriveDevice",
    "dhd": "dhd_device.DhdDevice",
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
    module, _, name = _DRIVERS[address.scheme].partition(".")
    driver = getattr(import_module(f"springpot.host.devices.{module}"), name)
    opened: OpenedDevice = driver(address, requirements)
    return opened
