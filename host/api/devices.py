"""Devices that press and render: addresses, requirements, what a press drives.

>>> from springpot.devices import parse_device
>>> address = parse_device("serial:///dev/ttyACM0?baud=921600")
>>> address.scheme, address.place, address.number("baud", 115200, 9600, 4e6)
('serial', '/dev/ttyACM0', 921600.0)
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.host.devices.device import (
        FORCE_ZERO as FORCE_ZERO,
        ZERO_S as ZERO_S,
        DeviceRequirements as DeviceRequirements,
        OpenedDevice as OpenedDevice,
        VirtualDevice as VirtualDevice,
        at_most as at_most,
        require_sample_rate as require_sample_rate,
        too_weak as too_weak,
    )
    from springpot.host.devices.drivers import (
        Driver as Driver,
        driver_of as driver_of,
        open_device as open_device,
        parse_device as parse_device,
    )
    from springpot.host.devices.url import (
        Address as Address,
        parse_address as parse_address,
    )
    from springpot.host.recording.indentation import (
        OPEN_LOOP as OPEN_LOOP,
        Limits as Limits,
        PressedDevice as PressedDevice,
        press_step_functions as press_step_functions,
        rest as rest,
        trip_error as trip_error,
    )
    from springpot.host.recording.press_rows import PressRows as PressRows
    from springpot.host.recording.session import open_press_device as open_press_device
    from springpot.host.wings.devices.can import (
        can_database as can_database,
        python_can_bus as python_can_bus,
    )
    from springpot.host.wings.devices.serial_device import (
        SerialDevice as SerialDevice,
    )
    from springpot.host.wings.devices.serial_port import (
        latency_timer as latency_timer,
        open_port as open_port,
        require_fast_adapter as require_fast_adapter,
    )
    from springpot.host.wings.devices.wire import (
        constant as constant,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
