"""The drivers that springpot brings, and the one call that opens a device of any driver."""

from springpot.codegen.errors import UsageError
from springpot.host.devices.device import DeviceRequirements, OpenedDevice
from springpot.host.devices.driver import Driver, drivers
from springpot.host.devices.url import Address, parse_address

_HERE = "springpot.host.devices"
# Registered in pyproject.toml; each module is loaded when a device of it is opened: a simulated
# device needs no serial port.
SIM = Driver(
    "sim://OBJECT, for example sim://ecoflex-00-30?hand=mid",
    f"{_HERE}.virtual:simulated_device", virtual=True, place=0,
)  # fmt: skip
REPLAY = Driver(
    "replay://FILE, a recording", f"{_HERE}.virtual:ReplayDevice", virtual=True, place=1
)
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
        raise UsageError(
            f"{url}: only dhd:// devices hold a handle's weight up: leave [device] weight_n out"
        )
    if requirements.force_sign == -1 and driver.own_frame:
        raise UsageError(
            f"{url}: its position and force have one frame: leave [device] force_sign out"
        )
    return driver.function()(address, requirements)
