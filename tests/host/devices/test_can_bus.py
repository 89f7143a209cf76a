"""Serial ports, a bus of python-can in a process of its own, a raw CAN socket: opened and used."""

import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path

import can
import pytest
import serial
from support.peer import peer

from springpot.codegen.errors import DeviceError
from springpot.host.devices import can_bus, serial_port
from springpot.host.devices.can_bus import CanBus
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.odrive import identifier

TRAIN = "m_per_turn=0.1&max_torque_nm=1&nm_per_a=0.1"
GROUP, PORT = "239.74.163.3", 43300 + os.getpid() % 1000  # of this process alone


@pytest.fixture
def bus():
    """Our end of a multicast group within this machine, opened as a device's."""
    opened = CanBus(parse_device(f"odrive://udp_multicast/{GROUP}?port={PORT}&{TRAIN}"), 1_000_000)
    yield opened
    opened.close()


@pytest.fixture
def others():
    group = {"channel": GROUP, "port": PORT, "hop_limit": 0}
    with can.Bus(interface="udp_multicast", **group) as found:
        yield found


def test_a_bus_of_python_can_carries_the_same_frames(bus, others):
    for wrong in ({"is_extended_id": True}, {"is_remote_frame": True}, {"is_error_frame": True}):
        message = {"arbitration_id": 0x29, "is_extended_id": False, **wrong}
        others.send(can.Message(**message))
    others.send(can.Message(arbitration_id=0x29, data=b"abc", is_extended_id=False))
    assert bus.receive(time.monotonic() + 5) == (0x29, b"abc")
    assert bus.receive(time.monotonic()) is None
    bus.send(identifier(1, 0x0E), b"abcdefgh")
    bus.send(identifier(1, 0), b"", remote=True)
    sent = {message.arbitration_id: message for message in iter(lambda: others.recv(0.5), None)}
    assert bytes(sent[0x2E].data) == b"abcdefgh"
    assert not (sent[0x2E].is_extended_id or sent[0x2E].is_remote_frame)
    assert sent[0x20].is_remote_frame


def test_the_last_frames_reach_a_bus_of_python_can(bus, others):
    """Zero force is sent last: it goes out before the bus is left."""
    for k in range(100):
        bus.send(k, b"")
    bus.close()
    assert [others.recv(0).arbitration_id for _ in range(100)] == list(range(100))
    assert bus._bridge.returncode == 0


def test_a_slow_bus_of_python_can_refuses_forces(bus):
    """What waits for it is a few frames: forces of long ago are never sent."""
    os.kill(bus._bridge.pid, signal.SIGSTOP)
    frame, taken = struct.pack("=IB3x8s", 0x2E, 8, bytes(8)), 0
    with pytest.raises(BlockingIOError):
        while taken < 1000:
            taken += os.write(bus.fd, frame) > 0
    assert 4 <= taken <= 20  # arming a drive takes four at once
    with pytest.raises(DeviceError, match="its queue stays full"):
        bus.send(0x2E, bytes(8))
    os.kill(bus._bridge.pid, signal.SIGCONT)


def test_a_bus_of_python_can_that_fails_is_gone(monkeypatch, tmp_path):
    """The loop reads the end of the socket, the session the reason."""
    program = tmp_path / "bridge.py"
    program.write_text(
        "import socket, sys\nnear = socket.socket(fileno=int(sys.argv[2]))\n"
        "near.send(bytes(16))\nnear.recv(16)\nprint('cable cut')\n"
    )
    monkeypatch.setattr(can_bus, "BRIDGE", program)
    bus = CanBus(parse_device(f"odrive://pcan/PCAN_USBBUS1?{TRAIN}"), 1_000_000)
    bus.send(0x2E, bytes(8))
    with pytest.raises(DeviceError, match=r"PCAN_USBBUS1.*: cable cut: check the bus"):
        bus.receive(time.monotonic() + 5)
    assert os.read(bus.fd, 16) == b""
    with pytest.raises(DeviceError, match="cable cut"):
        bus.send(0x2E, bytes(8))
    bus.close()


@pytest.mark.parametrize(
    ("place", "reason"),
    [("nonsense/x", "nonsense"), ("pcan/x", "pcan"), ("slcan//dev/null", "configure port")],
)
def test_a_bus_that_cannot_be_opened_says_why(place, reason):
    with pytest.raises(DeviceError, match=rf"odrive://{place}.*: .*{reason}"):
        CanBus(parse_device(f"odrive://{place}?{TRAIN}"), 1_000_000)


def test_damaged_lines_of_an_adapter_are_no_frames():
    with peer("slcan_odrive", "--damage", 0.3) as drive:
        bus = CanBus(parse_device(drive.url), 1_000_000)
        until_s = time.monotonic() + 2
        frames = [bus.receive(until_s) for _ in range(300)]
        bus.close()
    good = [frame for frame in frames if frame and frame[0] == identifier(0, 9)]
    assert len(good) > 150 and all(len(data) <= 8 for _, data in filter(None, frames))


def test_a_raw_can_socket_carries_the_same_frames(monkeypatch):
    """The bus of socketcan over a pair of sockets: the kernel here may have no CAN."""
    far, near = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    monkeypatch.setattr(can_bus, "_kernel_socket", lambda _address: near)
    bus = CanBus(parse_device(f"odrive://socketcan/can0?{TRAIN}"), 1_000_000)
    threading.Timer(0.02, lambda: far.send(struct.pack("=IB3x8s", 0x29, 8, bytes(8)))).start()
    assert bus.receive(time.monotonic() + 2) == (0x29, bytes(8))
    assert bus.receive(time.monotonic()) is None
    bus.send(identifier(1, 0x0E), b"abcdefgh")
    assert struct.unpack("=IB3x8s", far.recv(16)) == (0x2E, 8, b"abcdefgh")
    bus.send(identifier(1, 0), b"", remote=True)
    assert struct.unpack("=IB3x8s", far.recv(16))[0] == 0x40000020
    far.close()
    bus.close()


def refused(place: object) -> str:
    with pytest.raises(DeviceError) as error:
        serial_port.open_port(str(place), 9600)
    return str(error.value).removeprefix(f"{place}: ")


@pytest.mark.parametrize("wrong", [OSError, serial.SerialException, ValueError])
def test_a_port_that_cannot_be_opened_is_told_with_who_has_it(tmp_path, monkeypatch, wrong) -> None:
    port = tmp_path / "port"
    port.touch()
    users = iter(["", "", "", "cat (process 7)", "dog (process 8)"])
    monkeypatch.setattr(serial_port, "used_by", lambda place: next(users))

    def fails(*_, **__):
        raise wrong("busy")

    monkeypatch.setattr(serial_port.serial, "Serial", fails)
    assert refused(port) == "cannot be opened: busy"
    assert refused(port) == "cannot be opened: in use by cat (process 7): end that program first"
    assert refused(port) == "in use by dog (process 8): end that program first"


def test_who_has_a_port_is_found_behind_links(tmp_path: Path) -> None:
    port, link = tmp_path / "port", tmp_path / "link"
    port.touch()
    link.symlink_to(port)
    code = "import sys; f = [*map(open, sys.argv[1:])]; print(flush=True); sys.stdin.read()"
    with port.open():
        assert serial_port.used_by(str(link)) == ""  # oneself does not count
        for opens in ([], [str(port)]):
            command, pipe = [sys.executable, "-c", code, *opens], subprocess.PIPE
            other = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)
            other.stdout.readline()
            name = Path(f"/proc/{other.pid}/comm").read_text().strip()
            assert serial_port.used_by(str(link)) == (
                f"{name} (process {other.pid})" if opens else ""
            )
            other.communicate()
    assert serial_port.used_by(str(link)) == ""


def test_a_latency_timer_is_looked_up_by_the_real_name(tmp_path, monkeypatch) -> None:
    assert Path("/sys/bus/usb-serial/devices") == serial_port.USB_SERIAL
    monkeypatch.setattr(serial_port, "USB_SERIAL", tmp_path)
    place = tmp_path / "by-name"
    place.symlink_to(tmp_path / "ttyUSB3")
    assert serial_port.latency_timer(str(place)) is None
    serial_port.require_fast_adapter(str(place), 8000)
    file = tmp_path / "ttyUSB3" / "latency_timer"
    file.parent.mkdir()
    borders = ((16, 62, True), (16, 63, False), (1, 8000, True), (2, 500, True), (2, 501, False))
    for timer_ms, rate_hz, fits in borders:
        file.write_text(f"{timer_ms}\n")
        assert serial_port.latency_timer(str(place)) == (file, timer_ms)
        if fits:
            serial_port.require_fast_adapter(str(place), rate_hz)
            continue
        with pytest.raises(DeviceError) as error:
            serial_port.require_fast_adapter(str(place), rate_hz)
        assert str(error.value) == (
            f"{place}: the adapter's latency timer is {timer_ms} ms, {1000 // timer_ms} exchanges "
            f"a second: `echo 1 | sudo tee {file}`"
        )
