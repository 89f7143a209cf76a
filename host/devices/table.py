"""Drivers of these devices, registered in pyproject.toml; each loads its module when it opens."""

from springpot.host.devices.drivers import Driver

_HERE = "springpot.host.devices"
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
