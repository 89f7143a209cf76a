"""Devices still://DEPTH_MM, which stay where they are."""

from pathlib import Path
from typing import Any

from springpot.codegen.errors import UsageError
from springpot.codegen.native.c_library import CLibrary
from springpot.host.devices.device import DeviceRequirements, VirtualDevice
from springpot.host.devices.drivers import Address, Driver


class StillDevice(VirtualDevice):
    """A tool that stays at one depth."""

    def __init__(self, address: Address, requirements: DeviceRequirements) -> None:
        """Take the depth of the URL, mm. Raises UsageError for no number and for a setting."""
        address.require_known(())
        try:
            self._depth_m = 1e-3 * float(address.place)
        except ValueError:
            raise UsageError(f"{address.url}: give a depth in mm, such as still://3") from None
        self._memory: Any = None

    def link(self, library: CLibrary) -> Any:
        self._memory = library.memory(library.c.sp_link_still_size())
        return library.c.sp_link_still_init(self._memory, self._depth_m)


STILL = Driver(
    "still://3, a depth in mm",
    StillDevice,
    virtual=True,
    links=(Path(__file__).with_name("still.c"),),
)
