"""Frames through a bus of python-can, and through a raw CAN socket."""

import os
import socket
import struct
import threading
import time

import can
import pytest

from springpot.codegen.errors import DeviceError
from springpot.host.devices.can_bus import SocketBus, open_bus
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.odrive import (
    identifier,
)

TRAIN = "m_per_turn=0.1&max_torque_nm=1&nm_per_a=0.1"


@pytest.fixture
def virtual():
    """A bus of python-can in this process: our end of it, opened as a device's, and the others'."""
    with can.Bus(interface="virtual", channel="test") as others:
        bus = open_bus(parse_device(f"odrive://virtual/test?{TRAIN}"), 1_000_000)
        yield bus, others
        bus.close()


def test_a_bus_of_python_can_carries_the_same_frames(virtual):
    bus, others = virtual
    for wrong in ({"is_extended_id": True}, {"is_remote_frame": True}, {"is_error_frame": True}):
        message = {"arbitration_id": 0x29, "is_extended_id": False, **wrong}
        others.send(can.Message(**message))
    others.send(can.Message(arbitration_id=0x29, data=b"abc", is_extended_id=False))
    assert bus.receive(time.monotonic() + 5) == (0x29, b"abc")
    assert bus.receive(time.monotonic()) is None
    bus.send(identifier(1, 0x0E), b"abcdefgh")
    bus.send(identifier(1, 0), b"", remote=True)
    torque, question = others.recv(5), others.recv(5)
    assert (torque.arbitration_id, bytes(torque.data)) == (0x2E, b"abcdefgh")
    assert not (torque.is_extended_id or torque.is_remote_frame)
    assert (question.arbitration_id, question.is_remote_frame) == (0x20, True)


def test_the_last_frames_reach_a_bus_of_python_can(virtual):
    """Zero force is sent last: it goes out before the bus is left."""
    bus, others = virtual
    for k in range(100):
        bus.send(k, b"")
    bus.close()
    assert [others.recv(0).arbitration_id for _ in range(100)] == list(range(100))


def test_a_slow_bus_of_python_can_refuses_forces(virtual):
    """What waits for it is a few frames: forces of long ago are never sent."""
    bus, _ = virtual
    sent = threading.Event()
    bus._bridge._bus.send = lambda _message: sent.wait(10)
    frame, taken = struct.pack("=IB3x8s", 0x2E, 8, bytes(8)), 0
    with pytest.raises(BlockingIOError):
        while taken < 1000:
            taken += os.write(bus.fd, frame) > 0
    assert 4 <= taken <= 20  # arming a drive takes four at once
    with pytest.raises(DeviceError, match="its queue stays full"):
        bus.send(0x2E, bytes(8))
    sent.set()


def test_a_bus_of_python_can_that_fails_is_gone(virtual):
    """The loop reads the end of the socket, the session the reason."""
    bus, others = virtual

    def fail(_message):
        raise can.CanOperationError("cable cut")

    bus._bridge._bus.send = fail
    bus.send(0x2E, bytes(8))
    with pytest.raises(DeviceError, match=r"virtual/test.*: cable cut: check the bus"):
        bus.receive(time.monotonic() + 5)
    assert os.read(bus.fd, 16) == b""
    others.send(can.Message(arbitration_id=0x29, is_extended_id=False))
    with pytest.raises(DeviceError, match="cable cut"):
        bus.send(0x2E, bytes(8))


def test_a_raw_can_socket_carries_the_same_frames():
    """The bus of socketcan over a pair of sockets: the kernel here may have no CAN."""
    far, near = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    address = parse_device(f"odrive://socketcan/can0?{TRAIN}")
    bus = SocketBus(address, near)
    threading.Timer(0.02, lambda: far.send(struct.pack("=IB3x8s", 0x29, 8, bytes(8)))).start()
    assert bus.receive(time.monotonic() + 2) == (0x29, bytes(8))
    assert bus.receive(time.monotonic()) is None
    bus.send(identifier(1, 0x0E), b"abcdefgh")
    assert struct.unpack("=IB3x8s", far.recv(16)) == (0x2E, 8, b"abcdefgh")
    bus.send(identifier(1, 0), b"", remote=True)
    assert struct.unpack("=IB3x8s", far.recv(16))[0] == 0x40000020
    far.close()
    bus.close()
