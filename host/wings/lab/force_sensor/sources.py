"""Where a sensor's samples come from: a springpot serial device, or a signal of a CAN bus."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from springpot import DeviceError, UsageError
from springpot.devices import (
    Address,
    DeviceRequirements,
    SerialDevice,
    can_database,
    constant,
    parse_address,
    python_can_bus,
)
from springpot.host.wings.lab.force_sensor.sensor import ForceSensor, Stamped

SENSORS = {
    "serial": "serial:///dev/ttyACM1?baud=921600",
    "can": "can://socketcan/can0?dbc=sensor.dbc&signal=Fz",
}
_RATE_HZ, _BITRATE = 1000.0, 1_000_000
_WAIT_S, _LOOK_S = 0.05, 0.0005
_NEWTONS = {"N": 1.0, "mN": 1e-3, "kN": 1e3}


class SerialSource:
    """Samples of a springpot serial device with a load cell; its frames' numbers are its clock."""

    def __init__(self, address: Address) -> None:
        """Open and start it. Raises DeviceError."""
        address.require_known(("baud", "n_per_unit"))
        settings = {key: text for key, text in address.settings.items() if key != "n_per_unit"}
        plain = Address(address.url, "serial", "", address.place, settings)
        self._factor = _factor(address)
        self._device = SerialDevice(plain, DeviceRequirements(_RATE_HZ, 0.02, 0.0, senses=True))

    def read(self) -> Sequence[Stamped]:
        until_s = time.monotonic() + _WAIT_S
        taken: list[Stamped] = []
        while not taken and time.monotonic() < until_s:
            for frame in self._device.frames():
                if frame.name != "sample" or frame.old:
                    continue
                if not frame.values["status"] & constant("LOAD_CELL"):
                    raise DeviceError(
                        f"{self._device.address.url}: its samples carry no force: give a device "
                        "with a load cell"
                    )
                force_n = self._factor * frame.values["measured_n"]
                taken.append(Stamped(frame.sequence / _RATE_HZ, force_n))
            if not taken:
                time.sleep(_LOOK_S)
        return taken

    def close(self) -> None:
        self._device.stop()
        self._device.close()


class CanSource:
    """A signal of a CAN bus, decoded by its database; time stamps are the interface's."""

    def __init__(self, address: Address) -> None:
        """Open the bus. Raises UsageError for a wrong setting, DeviceError for the bus."""
        address.require_known(("bitrate", "port", "dbc", "signal", "n_per_unit"))
        self._url = address.url
        for key in ("dbc", "signal"):
            if key not in address.settings:
                raise UsageError(f"{address.url}: no {key}: use {SENSORS['can']}")
        self._signal = address.settings["signal"]
        database = can_database(Path(address.settings["dbc"]))
        self._message = next(
            (message for message in database.messages
             if any(signal.name == self._signal for signal in message.signals)), None,
        )  # fmt: skip
        if self._message is None:
            raise UsageError(
                f"{address.url}: {address.settings['dbc']} has no signal {self._signal!r}"
            )
        self._factor = self._newtons_per_unit(address)
        bitrate = int(address.number("bitrate", _BITRATE, 1e4, 1e6))
        self._bus: Any = python_can_bus(address, bitrate)

    def read(self) -> Sequence[Stamped]:
        taken: list[Stamped] = []
        wait_s = _WAIT_S
        message: Any = self._message
        while (frame := self._bus_frame(wait_s)) is not None:
            wait_s = 0.0
            if frame.arbitration_id != message.frame_id or frame.is_error_frame:
                continue
            try:
                value = message.decode(bytes(frame.data), decode_choices=False)[self._signal]
            except Exception as error:  # cantools and bitstruct raise many kinds
                reason = " ".join(str(error).split())
                raise DeviceError(
                    f"{self._url}: a frame of {message.name} is not as the database says "
                    f"({reason}): correct the database"
                ) from None
            taken.append(Stamped(frame.timestamp, self._factor * float(value)))
        return taken

    def close(self) -> None:
        self._bus.shutdown()

    def _bus_frame(self, wait_s: float) -> Any:
        import can

        try:
            return self._bus.recv(wait_s)
        except (can.CanError, OSError) as error:
            raise DeviceError(f"{self._url}: went away ({error}): check the bus") from None

    def _newtons_per_unit(self, address: Address) -> float:
        if "n_per_unit" in address.settings:
            return _factor(address)
        message: Any = self._message
        unit = message.get_signal_by_name(self._signal).unit
        if unit not in _NEWTONS:
            raise UsageError(
                f"{address.url}: the unit of {self._signal} is {unit or 'not stated'}: say how "
                "many newtons one is, &n_per_unit="
            )
        return _NEWTONS[unit]


def _factor(address: Address) -> float:
    factor = address.number("n_per_unit", 1.0, -1e6, 1e6)
    if factor == 0.0:
        raise UsageError(f"{address.url}: n_per_unit=0: say how many newtons one unit is")
    return factor


def open_sensor(url: str) -> ForceSensor:
    """Open the sensor of a URL, and see that it is fast enough.

    Raises UsageError for a wrong URL, DeviceError with one line for whatever else is wrong.
    """
    address = parse_address(url, SENSORS, "sensor", on_bus=("can",))
    source = SerialSource(address) if address.scheme == "serial" else CanSource(address)
    sensor = ForceSensor(url, source)
    try:
        sensor.require_rate()
    except BaseException:
        sensor.close()
        raise
    return sensor
