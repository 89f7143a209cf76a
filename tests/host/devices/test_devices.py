"""Devices that cannot be used: one line each, that says what, where and what to do."""

import time
from types import SimpleNamespace

import numpy as np
import pytest
from support.peer import peer, wait_until

from springpot.codegen.errors import DeviceError, SpringpotError, UsageError
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.serial_device import SerialDevice
from springpot.host.devices.wire import Receiver, Sender
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
    assert ("command", False) in new
    assert ("command", True) not in new


@pytest.mark.realtime
def test_recording_on_a_serial_device(monkeypatch):
    """Force control through the wire follows the command; limits end a press with zero force.

    The device's time passes with the forces, the watchdogs wait and a period of the loop is longer
    than the device's: how long a busy machine keeps its process away does not matter.
    """
    monkeypatch.setattr(indentation, "WATCHDOG_S", 2.0)
    monkeypatch.setattr(
        indentation,
        "LoopSettings",
        lambda **settings: LoopSettings(**settings | {"period_s": 0.005, "seconds": 20.0}),
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
            wait_until(lambda: time.monotonic() > fault_s + 0.05, 5, "no time")
            session.reset()
            wait_until(lambda: session.state.resets == 1, 5, "no reset")
            at = session.state.ticks
            wait_until(lambda: session.state.ticks > at + 300, 5, "no ticks")
            assert session.state.watchdog_trips == 1
            assert not session.state.tripped
        assert len(device.named("reset")) == 1
        device.wait_for("stop")
        assert any(event["was_n"] > 0 for event in device.named("zero"))
