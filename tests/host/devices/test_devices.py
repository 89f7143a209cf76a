"""Devices as processes: sessions, watchdogs, limits, rates; one line for what cannot be used."""

import re
import time
from types import SimpleNamespace

import numpy as np
import pytest
from support.peer import peer, wait_until
from support.sessions import ended, faithful

from springpot.codegen.errors import DeviceError, SpringpotError, UsageError
from springpot.host.cli import exit_status
from springpot.host.devices import device as device_module
from springpot.host.devices.device import DeviceRequirements, require_sample_rate
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.odrive_device import OdriveDevice
from springpot.host.devices.serial_device import SerialDevice
from springpot.host.devices.wire import Receiver, Sender
from springpot.host.native.c_library import Stop
from springpot.host.recording import indentation
from springpot.host.recording.indentation import Limits
from springpot.host.recording.session import open_press_device
from springpot.host.session.outcome import LoopSettings
from springpot.host.session.session import Session

NEEDS = DeviceRequirements(1000, 0.02, 12.0)


def test_stop_is_new_however_many_forces_the_loop_sent():
    """A device that obeys new commands only hears it: the loop's numbers are far ahead."""
    sent, device = bytearray(), SerialDevice.__new__(SerialDevice)
    device.address, device.requirements = parse_device("serial:///dev/x"), NEEDS
    device.sender, device.receiver = Sender(), Receiver()
    device.port = SimpleNamespace(write=sent.extend, read=lambda _: b"")
    device.stop()
    loop, far = Sender(), Receiver()
    loop.sequence = 1 << 21
    (force,) = far.feed(loop.encode("force", force_n=1.0))
    assert not force.old
    new = []
    for frame in far.feed(bytes(sent)):
        if frame.name == "ask":
            far.restart()
        new.append((frame.name, frame.old))
    assert ("command", False) in new and ("command", True) not in new


@pytest.mark.realtime
def test_recording_on_a_serial_device(monkeypatch):
    """Force control through the wire follows the command; limits end a press with zero force.

    The device's time passes with the forces, the watchdogs wait and a period of the loop is longer
    than the device's: how long a busy machine keeps its process away does not matter.
    """
    monkeypatch.setattr(indentation, "WATCHDOG_S", 0.5)
    monkeypatch.setattr(
        indentation,
        "LoopSettings",
        lambda **settings: LoopSettings(**settings | {"period_s": 0.003, "seconds": 20.0}),
    )
    command_n = 4 * np.sin(np.linspace(0, np.pi, 600)) ** 2
    with peer("serial_device", "--object", "dragon-skin-fx", "--lockstep") as device:
        taken = []
        opened = open_press_device(device.url, object_name="pad")
        assert opened.object_name == "pad"
        position_m, force_n = opened.press(command_n, lambda x, f: taken.append((x, f)))
        np.testing.assert_array_equal(np.concatenate([x for x, _ in taken]), position_m)
        assert len(position_m) == len(force_n) == 600
        assert np.sqrt(np.mean((force_n - command_n) ** 2)) < 0.4
        again, _ = opened.press(command_n)
        assert again.max() == pytest.approx(position_m.max(), rel=0.1)
        with pytest.raises(SpringpotError, match="mm deep, the limit is 1 mm"):
            open_press_device(device.url, limits=Limits(max_depth_m=1e-3)).press(command_n)
        assert device.wait_for("stop", more=2)["force_n"] == 0


@pytest.mark.realtime
def test_a_serial_device_that_falls_silent_ends_a_press():
    with (
        peer("serial_device", "--silent-after", 0.2) as device,
        pytest.raises(DeviceError, match="silent for 20 ms while pressing"),
    ):
        open_press_device(device.url, limits=Limits(9.0)).press(np.full(3000, 2.0))
    with pytest.raises(UsageError, match="cannot be pressed"):
        open_press_device("replay://x.h5")


@pytest.mark.realtime
def test_a_device_that_tripped_takes_forces_after_a_reset(folder):
    """It switched its motor off by itself: one reset by the user, and it stays on."""
    with peer("serial_device", "--trip-after", 0.4, "--presses-hz", 4) as device:
        with Session(folder, device.url, report=list) as session:
            session.start()
            wait_until(lambda: session.state.tripped, 5, "no trip")
            fault_s = device.wait_for("fault")["at_s"]
            wait_until(lambda: time.perf_counter() > fault_s + 0.05, 5, "no time")
            session.reset()
            wait_until(lambda: session.state.resets == 1, 5, "no reset")
            at = session.state.ticks
            wait_until(lambda: session.state.ticks > at + 300, 5, "no ticks")
            assert session.state.watchdog_trips == 1 and not session.state.tripped
        assert len(device.named("reset")) == 1
        device.wait_for("stop")
        assert any(event["was_n"] > 0 for event in device.named("zero"))


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
    assert session.scheduler().startswith("C thread") and abs(result["ticks"] - 1500) <= 2
    assert result["ring_dropped"] == result["crc_errors"] == 0 and result["samples"] > 1400
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
    assert session.scheduler().startswith("C thread") and session.result()["samples"] > 800
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
    assert np.sqrt(np.mean((force_n - command_n) ** 2)) < 0.2 and position_m.max() > 5e-4
    with peer("udp_odrive", "--port", 43221, "--on-object") as drive:
        position_m, force_n = open_press_device(drive.url).press(command_n)
    assert np.sqrt(np.mean((force_n - command_n) ** 2)) < 0.2
    with (
        peer("slcan_odrive", "--on-object", "--firmware", "0.5") as drive,
        pytest.raises(DeviceError, match="measures no force"),
    ):
        open_press_device(drive.url).press(command_n)


@pytest.fixture
def count_of(monkeypatch):
    """Make a count that waits on a clock of its own: samples of each window, given as rates."""
    clock = [0.0]
    monkeypatch.setattr(device_module.time, "perf_counter", lambda: clock[0])

    def make(*rates_hz):
        rates, windows_s = iter(rates_hz), []

        def count(until_s):
            windows_s.append(until_s - clock[0])
            clock[0] = until_s
            return round(windows_s[-1] * next(rates))

        return count, windows_s

    return make


@pytest.mark.parametrize("rates_hz", [(1000,), (900,), (3000,), (500, 1000), (0, 0, 990), (0,) * 3])
def test_enough_samples_or_none_which_is_the_sessions_matter(count_of, rates_hz):
    count, windows_s = count_of(*rates_hz)
    require_sample_rate("x", 1000, count, "do this")
    assert windows_s == pytest.approx([0.1] * len(rates_hz))


@pytest.mark.parametrize("rates_hz", [(100, 100, 100), (880, 880, 880), (0, 10, 0)])
def test_too_few_samples(count_of, rates_hz):
    count, _ = count_of(*rates_hz)
    told = f"x: sends {max(rates_hz)} samples a second, the scene runs at 1000 Hz: do this"
    with pytest.raises(DeviceError, match=told):
        require_sample_rate("x", 1000, count, "do this")


@pytest.mark.realtime
def test_a_rate_that_falls_in_a_session(folder):
    with peer("serial_device", "--thin-after", 0.4) as device:
        session = ended(folder, device.url)
        assert device.wait_for("stop")["force_n"] == 0
    assert session.state.reason == Stop.RATE
    assert "for a fifth of the last 100 periods of 1 ms no sample came" in session.line
    assert "set its firmware to 1000 Hz" in session.line and exit_status(session.error) == 5
