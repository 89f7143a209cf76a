"""Drives as processes: sessions, watchdogs, limits, refusals."""

import contextlib
import dataclasses
import math
import re
import struct
import threading
import time

import can
import numpy as np
import pytest
from axis import Axis, add_options
from can.interfaces.udp_multicast import UdpMulticastBus
from line import arguments
from support.peer import peer, wait_until
from support.small import model_file, scene

from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.scene import Guard
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.odrive import (
    CLOSED_LOOP,
    ENCODER,
    Drive,
    DriveLimits,
    parse_heartbeat,
)
from springpot.host.devices.odrive_device import OdriveDevice, _transmission
from springpot.host.emission.emission import emit
from springpot.host.native.loop_library import RESET, UNSENT
from springpot.host.recording.session import open_press_device
from springpot.host.session.session import Session
from springpot.host.validation.validation import validate
from springpot.trainer.recordings.recording_file import read_recording

TRAIN = "m_per_turn=0.1&max_torque_nm=1&nm_per_a=0.1"
NODE = 3


@pytest.mark.realtime
@pytest.mark.parametrize("firmware", ["0.5", "0.6"])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_drive_over_slcan(tmp_path, folder, firmware, sign):
    log = tmp_path / "a.h5"
    options = ("--firmware", firmware, "--sign", sign, "--node", NODE)
    with (
        peer("slcan_odrive", *options) as drive,
        Session(folder, drive.url, log, seconds=1.5, report=list) as session,
    ):
        session.start()
        wait_until(lambda: session.runner.over, 20, "does not end")
        time.sleep(0.05)
    result = session.result()
    assert session.runner.scheduler().startswith("C thread")
    assert abs(result["ticks"] - 1500) <= 2
    assert result["ring_dropped"] == result["crc_errors"] == 0
    assert result["samples"] > 1400
    read = read_recording(log)
    assert validate(folder, [read], paced_s=0.01).mismatches == 0
    assert read.position_m.max() > 3e-3
    assert [event["state"] for event in drive.named("state")] == [8, 8, 1]
    assert len(drive.named("tripped")) >= 1  # the proof of its watchdog


@pytest.mark.realtime
def test_a_drive_over_udp_multicast(tmp_path, folder):
    """Any interface of python-can: the same loop, and the log is as faithful."""
    log = tmp_path / "a.h5"
    with (
        peer("udp_odrive", "--port", 43219) as drive,
        Session(folder, drive.url, log, seconds=1.0, report=list) as session,
    ):
        session.start()
        wait_until(lambda: session.runner.over, 20, "does not end")
    assert session.runner.scheduler().startswith("C thread")
    assert session.result()["samples"] > 800
    assert validate(folder, [read_recording(log)], paced_s=0.01).mismatches == 0


def test_a_bus_of_python_can_that_fails_in_a_session(tmp_path, monkeypatch):
    """A device that is gone: zero until it was opened and checked again, then ramped in."""
    patient = dataclasses.replace(scene(), guard=Guard(watchdog_ms=300))
    folder = tmp_path / "c"
    emit(patient, model_file(tmp_path), folder)
    log, broken, send = tmp_path / "a.h5", threading.Event(), UdpMulticastBus.send

    def fail_once(bus, message, timeout=None):
        if broken.is_set():
            broken.clear()
            raise can.CanOperationError("cable cut")
        send(bus, message, timeout)

    monkeypatch.setattr(UdpMulticastBus, "send", fail_once)
    with (
        peer("udp_odrive", "--port", 43223, "--watchdog-ms", 90) as drive,
        Session(folder, drive.url, log, report=list) as session,
    ):
        session.start()
        wait_until(lambda: session.runner.state.ticks > 100, 20, "no ticks")
        broken.set()
        wait_until(lambda: session.runner.state.disconnects == 1, 5, "not gone")
        wait_until(lambda: session.runner.state.connected, 20, "not back")
        at = session.runner.state.ticks
        wait_until(lambda: session.runner.state.ticks > at + 100, 20, "no ticks")
    read = read_recording(log)
    assert validate(folder, [read], paced_s=0.01).mismatches == 0
    call = read.channels["call"].astype(int)
    lost = np.flatnonzero(call & UNSENT)
    assert len(lost) > 250  # opening it again waits for its watchdog
    (reset,) = np.flatnonzero(call & RESET)
    assert reset > lost[250]
    assert read.force_n[reset] == 0


@pytest.mark.parametrize(("firmware", "watchdog_ms"), [("0.5", 1350), ("0.6", 300)])
def test_a_drive_with_a_slow_watchdog_is_refused(firmware, watchdog_ms):
    """It would keep its torque for so long after the host has died."""
    options = ("--firmware", firmware, "--watchdog-ms", watchdog_ms)
    with peer("slcan_odrive", *options) as drive:
        says = r"keeps its torque .*\((0\.[3-9]|1\.).* s, at most 0\.2 s.*watchdog_timeout = 0\.05"
        with pytest.raises(DeviceError, match=says):
            OdriveDevice(parse_device(drive.url), DeviceRequirements(1000, 0.02, 12.0))
        assert not drive.named("zero"), "it was given a torque"


def test_one_bound_in_time_proves_a_watchdog(monkeypatch):
    """A heartbeat may be lost: the least of three upper bounds counts, and refuses."""
    drive = Drive(None, 0, "odrive://x", DriveLimits(1, 1))
    monkeypatch.setattr(drive, "arm", lambda: None)
    monkeypatch.setattr(drive, "rest", lambda: None)
    for found_s, taken in (((0.3, 0.19), True), ((0.3, 0.25, 0.201), False), ((math.inf,), False)):
        found = iter(found_s)
        monkeypatch.setattr(drive, "_silent_until_off_s", lambda found=found: next(found))
        with contextlib.nullcontext() if taken else pytest.raises(DeviceError, match=r"0\.2 s"):
            drive._prove_watchdog()
        assert not list(found)


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


def test_a_drive_lets_every_force_through(monkeypatch):
    """At any speed of a hand, with the default gain of its limit or a small motor's."""
    address = parse_device("odrive://slcan//dev/x?m_per_turn=0.05&max_torque_nm=0.4&nm_per_a=0.04")
    train = _transmission(address, DeviceRequirements(1000, 0.02, 12.0))
    speed = 2.0 / 0.05
    for gain in (1 / 6, 0.4 / 20):
        assert gain * (train.limits.turns_per_s - speed) >= 0.4
    assert train.limits.current_a * 0.04 == pytest.approx(1.05 * 0.4)


def moved(options: dict, limits: bool, turns_per_s: float) -> tuple[Axis, list]:
    """A drive in closed loop that is told 0.4 Nm at that speed, for one step."""
    parser = arguments("a drive")
    add_options(parser)
    axis = Axis(parser.parse_args([f"--{key}={value}" for key, value in options.items()]))
    axis.take(0x07, struct.pack("<II", CLOSED_LOOP, 0))
    if limits:
        axis.take(0x0F, struct.pack("<ff", 40.0, 5.0))
    axis.take(0x0E, struct.pack("<f4x", 0.4))
    axis.turns_per_s = turns_per_s
    frames = axis.step()
    axis.turns_per_s = turns_per_s
    return axis, frames


def test_the_peer_limits_torque_and_speed_as_a_drive_does():
    """Without limits from us: 2 turns a second, off beyond 1.2 times it, 100 estimates a second."""
    options = {"nm-per-a": 0.1, "m-per-turn": 0.05}
    assert moved(options, True, 30.0)[0].given_nm() == pytest.approx(0.4)
    assert moved(options, False, 0.0)[0].given_nm() == pytest.approx(2 / 6)
    assert moved(options, False, 1.6)[0].given_nm() == pytest.approx(0.4 / 6)
    for firmware, error in (("0.5", 0x200), ("0.6", 0x8000)):
        axis, _ = moved({**options, "firmware": firmware}, False, 2.41)
        assert (axis.state, axis.error, axis.given_nm()) == (1, error, 0.0)
        beat = parse_heartbeat(axis._heartbeat()[1], firmware)
        assert (beat.error, beat.failed) == (error, firmware == "0.5")
    axis, frames = moved(options, True, 0.0)
    for _ in range(999):
        frames += axis.step()
    assert sum(found == ENCODER for found, _ in frames) == 100


def test_a_serial_device_is_no_adapter(folder):
    with peer("serial_device") as device:
        url = "odrive://slcan/" + device.url.removeprefix("serial://").split("?")[0]
        with pytest.raises(DeviceError, match="no slcan adapter"):
            Session(folder, f"{url}?{TRAIN}", report=list).__enter__()


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


@pytest.mark.parametrize(
    ("url", "error", "says"),
    [
        (f"odrive://slcan//dev/none?{TRAIN}", DeviceError, "no such port"),
        (f"odrive://socketcan/can9?{TRAIN}", DeviceError, "kernel needs CAN"),
        (f"odrive://nosuch/1?{TRAIN}", DeviceError, "nosuch"),
        ("odrive:///dev/ttyACM0", UsageError, "not complete"),
        (
            "odrive://slcan//dev/none?m_per_turn=1&max_torque_nm=0.1&nm_per_a=0.1",
            DeviceError,
            "max_force_n",
        ),
    ],
)
def test_wrong_urls_are_one_line(url, error, says):
    with pytest.raises(error, match=says) as caught:
        OdriveDevice(parse_device(url), DeviceRequirements(1000, 0.02, 12.0))
    assert "\n" not in str(caught.value)
