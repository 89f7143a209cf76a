"""Sensors over a serial line and over CAN: opened, timed, refused with the remedy."""

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from support.peer import peer

from springpot.codegen.errors import DataError, DeviceError, UsageError
from springpot.host.devices.drivers import parse_device
from springpot.host.wings.devices.can_bridge import python_can_bus
from springpot.host.wings.lab.force_sensor.sources import open_sensor

DBC = """VERSION ""
BU_: Sensor
BO_ 512 Force: 8 Sensor
 SG_ Fz : 0|16@1- (0.5,0) [-16000|16000] "{unit}" Vector__XXX
"""
URL = "can://virtual/springpot-force?"


@pytest.fixture
def database(tmp_path: Path) -> Path:
    file = tmp_path / "sensor.dbc"
    file.write_text(DBC.format(unit="mN"))
    return file


@pytest.fixture
def sending(request: pytest.FixtureRequest) -> Iterator[None]:
    """A bus with Fz = 2 N, so many times a second, among frames of others."""
    import can

    bus = python_can_bus(parse_device("odrive://virtual/springpot-force"), 1_000_000)
    over = threading.Event()

    def send() -> None:
        while not over.wait(1.0 / request.param):
            bus.send(can.Message(arbitration_id=0x100, data=bytes(8), is_extended_id=False))
            value = (4000).to_bytes(2, "little", signed=True)
            bus.send(can.Message(arbitration_id=512, data=value + bytes(6), is_extended_id=False))

    thread = threading.Thread(target=send, daemon=True)
    thread.start()
    yield
    over.set()
    thread.join()
    bus.shutdown()


@pytest.mark.realtime
@pytest.mark.parametrize("sending", [900], indirect=True)
@pytest.mark.usefixtures("sending")
def test_a_signal_of_a_bus(database: Path) -> None:
    """In millinewtons, as the database says; `n_per_unit` says otherwise."""
    for setting, expected_n in (("", 2.0), ("&n_per_unit=-0.01", -20.0)):
        sensor = open_sensor(f"{URL}dbc={database}&signal=Fz{setting}")
        sensor.forget()
        heard: list[float] = []
        sensor.on_force = heard.append
        time.sleep(0.2)
        times_s, forces_n = sensor.samples()
        sensor.close()
        assert len(times_s) > 40
        assert np.all(np.diff(times_s) > 0)
        assert np.allclose(forces_n, expected_n)
        assert heard
        assert heard[0] == pytest.approx(expected_n)
        assert abs(times_s[-1] - time.monotonic()) < 1.5


@pytest.mark.realtime
@pytest.mark.parametrize("sending", [80], indirect=True)
@pytest.mark.usefixtures("sending")
def test_a_sensor_that_is_too_slow(database: Path) -> None:
    with pytest.raises(DeviceError, match=r"sends \d+ samples a second.*HX711.*take a faster one"):
        open_sensor(f"{URL}dbc={database}&signal=Fz")


def test_what_is_wrong_with_a_url(database: Path, tmp_path: Path) -> None:
    with pytest.raises(DeviceError, match="no driver for 'sim': use serial:"):
        open_sensor("sim://ecoflex-00-30")
    with pytest.raises(UsageError, match="no dbc: use can://"):
        open_sensor(f"{URL}signal=Fz")
    with pytest.raises(UsageError, match="has no signal 'Fx'"):
        open_sensor(f"{URL}dbc={database}&signal=Fx")
    with pytest.raises(DataError, match="give a CAN database"):
        open_sensor(f"{URL}dbc={tmp_path}/none.dbc&signal=Fz")
    database.write_text(DBC.format(unit="kg"))
    with pytest.raises(UsageError, match="the unit of Fz is kg: say how many newtons"):
        open_sensor(f"{URL}dbc={database}&signal=Fz")


def test_a_serial_device_without_a_load_cell() -> None:
    with peer("serial_device") as device, pytest.raises(DeviceError, match="carry no force"):
        open_sensor(device.url)


def test_a_load_cell_on_a_serial_line() -> None:
    with peer("dhd_device", "--cell-ms", 5) as device:
        sensor = open_sensor(device.wait_for("cell")["url"] + "&n_per_unit=2")
        sensor.forget()
        time.sleep(0.3)
        times_s, forces_n = sensor.samples()
        sensor.close()
    assert len(times_s) > 100
    assert np.diff(times_s) == pytest.approx(1e-3, rel=0.05)
    assert np.std(forces_n) == pytest.approx(0.02, rel=0.3)
