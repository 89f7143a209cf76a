"""Drives as processes: sessions, watchdogs, limits, refusals."""

import re
import time

import numpy as np
import pytest
from support.peer import peer
from support.sessions import ended, faithful

from springpot.codegen.errors import DeviceError
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.odrive_device import OdriveDevice
from springpot.host.recording.session import open_press_device

NODE = 3


@pytest.mark.realtime
@pytest.mark.parametrize(("firmware", "sign"), [("0.5", 1), ("0.6", -1)])
def test_a_drive_over_slcan(tmp_path, folder, firmware, sign):
    log = tmp_path / "a.h5"
    options = ("--firmware", firmware, "--sign", sign, "--node", NODE)
    with peer("slcan_odrive", *options) as drive:
        session = ended(folder, drive.url, log, seconds=1.5)
        time.sleep(0.05)
    result = session.result()
    assert session.scheduler().startswith("C thread")
    assert abs(result["ticks"] - 1500) <= 2
    assert result["ring_dropped"] == result["crc_errors"] == 0
    assert result["samples"] > 1400
    read = faithful(folder, log)
    assert read.position_m.max() > 3e-3
    assert [event["state"] for event in drive.named("state")] == [8, 8, 1]
    assert len(drive.named("tripped")) >= 1  # the proof of its watchdog


@pytest.mark.realtime
def test_a_drive_over_udp_multicast(tmp_path, folder):
    """Any interface of python-can: the same loop, and the log is as faithful."""
    log = tmp_path / "a.h5"
    with peer("udp_odrive", "--port", 43219) as drive:
        session = ended(folder, drive.url, log, seconds=1.0)
    assert session.scheduler().startswith("C thread")
    assert session.result()["samples"] > 800
    faithful(folder, log)


def test_the_limit_that_a_refusal_names_is_taken():
    rng = np.random.default_rng(7)
    for _ in range(300):
        url = f"odrive://slcan//dev/none?nm_per_a=0.1&m_per_turn={rng.uniform(0.01, 1):.4f}"
        url += f"&max_torque_nm={rng.uniform(0.01, 1):.4f}"
        with pytest.raises(DeviceError, match="max_force_n") as caught:
            OdriveDevice(parse_device(url), DeviceRequirements(1000, 0.02, 1e4))
        named_n = float(re.search(r"max_force_n = ([\d.e+-]+),", str(caught.value))[1])
        with pytest.raises(DeviceError, match="no such port"):  # it got further
            OdriveDevice(parse_device(url), DeviceRequirements(1000, 0.02, named_n))


@pytest.mark.realtime
def test_recording_needs_the_torques_of_firmware_0_6():
    command_n = 2 * np.sin(np.linspace(0, np.pi, 300)) ** 2
    with peer("slcan_odrive", "--on-object", "--object", "dragon-skin-fx") as drive:
        position_m, force_n = open_press_device(drive.url).press(command_n)
    assert np.sqrt(np.mean((force_n - command_n) ** 2)) < 0.2
    assert position_m.max() > 5e-4
    with peer("udp_odrive", "--port", 43221, "--on-object") as drive:
        position_m, force_n = open_press_device(drive.url).press(command_n)
    assert np.sqrt(np.mean((force_n - command_n) ** 2)) < 0.2
    with (
        peer("slcan_odrive", "--on-object", "--firmware", "0.5") as drive,
        pytest.raises(DeviceError, match="measures no force"),
    ):
        open_press_device(drive.url).press(command_n)
