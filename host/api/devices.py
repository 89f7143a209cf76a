"""Devices that press and render: addresses, requirements, what a press drives.

>>> from springpot.devices import parse_device
>>> address = parse_device("serial:///dev/ttyACM0?baud=921600")
>>> address.scheme, address.place, address.number("baud", 115200, 9600, 4e6)
('serial', '/dev/ttyACM0', 921600.0)
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.host.devices.device import FORCE_ZERO as FORCE_ZERO
    from springpot.host.devices.device import ZERO_S as ZERO_S
    from springpot.host.devices.device import DeviceRequirements as DeviceRequirements
    from springpot.host.devices.device import OpenedDevice as OpenedDevice
    from springpot.host.devices.device import VirtualDevice as VirtualDevice
    from springpot.host.devices.device import at_most as at_most
    from springpot.host.devices.device import too_weak as too_weak
    from springpot.host.devices.drivers import Driver as Driver
    from springpot.host.devices.drivers import (
        driver_of as driver_of,
    )
    from springpot.host.devices.drivers import (
        open_device as open_device,
    )
    from springpot.host.devices.drivers import (
        parse_device as parse_device,
    )
    from springpot.host.devices.lines.can import (
        can_database as can_database,
    )
    from springpot.host.devices.lines.can import (
        python_can_bus as python_can_bus,
    )
    from springpot.host.devices.lines.serial_port import latency_timer as latency_timer
    from springpot.host.devices.lines.serial_port import open_port as open_port
    from springpot.host.devices.lines.serial_port import (
        require_fast_adapter as require_fast_adapter,
    )
    from springpot.host.devices.lines.wire import Sender as Sender
    from springpot.host.devices.lines.wire import constant as constant
    from springpot.host.devices.sample_rate import require_sample_rate as require_sample_rate
    from springpot.host.devices.serial_device import BAUD as BAUD
    from springpot.host.devices.serial_device import SerialDevice as SerialDevice
    from springpot.host.devices.url import (
        Address as Address,
    )
    from springpot.host.devices.url import (
        parse_address as parse_address,
    )
    from springpot.host.recording.indentation import (
        OPEN_LOOP as OPEN_LOOP,
    )
    from springpot.host.recording.indentation import (
        Limits as Limits,
    )
    from springpot.host.recording.indentation import (
        PressedDevice as PressedDevice,
    )
    from springpot.host.recording.indentation import (
        press_step_functions as press_step_functions,
    )
    from springpot.host.recording.indentation import (
        rest as rest,
    )
    from springpot.host.recording.indentation import (
        trip_error as trip_error,
    )
    from springpot.host.recording.press_rows import PressRows as PressRows
    from springpot.host.recording.session import open_press_device as open_press_device
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
