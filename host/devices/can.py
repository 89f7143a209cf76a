"""python-can: buses, and their refusals as one line."""

from typing import TYPE_CHECKING

from springpot.codegen.errors import DeviceError
from springpot.codegen.types import JsonObject
from springpot.host.devices.url import Address

if TYPE_CHECKING:
    import can


def python_can_bus(address: Address, bitrate: int) -> "can.BusABC":
    """Open a bus of python-can. Raises DeviceError with its own reason."""
    import can

    more: JsonObject = {"bitrate": bitrate}
    if address.interface == "udp_multicast":
        more = {"hop_limit": 0, "port": int(address.number("port", 43113, 1024, 65535))}
    elif address.interface == "virtual":
        more = {}
    try:
        return can.Bus(interface=address.interface, channel=address.place, **more)
    except (can.CanError, OSError, ValueError, ImportError) as error:
        reason = " ".join(str(error).split())
        raise DeviceError(f"{address.url}: {reason}: check it") from None
