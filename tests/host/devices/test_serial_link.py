"""The C link of a simple serial device, one call at a time: reset, acknowledged late or at once."""

import contextlib
import math
import os
import socket
from pathlib import Path

import pytest

from springpot.host.devices.wire import Receiver, Sender, constant
from springpot.host.native.c_library import loop_library

RUNNING, TRIPPED = constant("RUNNING"), constant("RUNNING") | constant("TRIPPED")
MS = 1_000_000  # ns


class SerialLink:
    """The link on a socket pair, and the device at the other end."""

    def __init__(self):
        library = loop_library("double")
        self.far, self.near = socket.socketpair()
        self.near.setblocking(False)
        self.far.setblocking(False)
        self.memory = library.memory(library.c.sp_link_serial_size())
        self.c = library.c.sp_link_serial_init(
            self.memory, self.near.fileno(), 0.0, 0.02, 1000.0, 7
        )
        self.motions = library.ffi.new("sp_motion[64]")
        self.sender, self.receiver = Sender(), Receiver()

    def sample(self, status):
        self.far.send(self.sender.encode("sample", status=status, position_m=0.0,
                                         velocity_mps=0.0, measured_n=0.0))  # fmt: skip

    def ack(self, command, refused=0):
        self.far.send(self.sender.encode("ack", command=command, refused=refused))

    def read(self, now_ns=0):
        return self.c.read(self.c, now_ns, self.motions, 64)

    def reset(self, now_ns=0):
        self.c.reset(self.c, now_ns)

    def commands(self):
        """Sequence numbers of the commands that came."""
        with contextlib.suppress(BlockingIOError):
            frames = list(self.receiver.feed(self.far.recv(65536)))
            return [frame.sequence for frame in frames if frame.name == "command"]
        return []


@pytest.fixture
def link():
    made = SerialLink()
    yield made
    made.near.close()
    made.far.close()


def test_samples_before_the_ack_are_of_the_old_trip(link):
    link.sample(TRIPPED)
    assert link.read() == -2
    link.reset()
    assert link.read() == 0
    link.sample(TRIPPED)
    assert link.read() == 1
    link.sample(TRIPPED)
    link.ack(*link.commands())
    link.sample(RUNNING)
    assert link.read() == 2
    link.sample(TRIPPED)  # it tripped again
    assert link.read() == -2


@pytest.mark.parametrize("round_trip_ms", [1, 12, 60, 400])
def test_any_ack_of_the_wish_makes_ready(link, round_trip_ms):
    """Asked again each 50 ms, however long an answer takes."""
    link.reset(0)
    under_way, ready_ms, sent = {}, None, 0
    for now_ms in range(1000):
        for command in link.commands():
            sent += 1
            under_way[now_ms + round_trip_ms] = command
        if now_ms in under_way:
            link.ack(under_way[now_ms])
        link.read(now_ms * MS)
        if ready_ms is None and link.c.ready:
            ready_ms = now_ms
    assert ready_ms == round_trip_ms and sent == 1 + round_trip_ms // 51


def test_an_ack_of_another_wish_is_none(link):
    link.reset(0)
    (first,) = link.commands()
    link.reset(MS)
    (second,) = link.commands()
    link.ack(first)
    link.ack(second, refused=1)
    link.ack(second + 1)
    link.read(2 * MS)
    assert link.c.ready == 0
    link.ack(second)
    link.read(3 * MS)
    assert link.c.ready == 1


def test_a_device_that_floods_does_not_keep_a_tick(link: SerialLink, tmp_path: Path) -> None:
    """64 KiB a call; what is more comes with the next ones, and nothing is lost."""
    flood = tmp_path / "flood"
    values = {"status": RUNNING, "position_m": 0.0, "velocity_mps": 0.0, "measured_n": 0.0}
    frames = [link.sender.encode("sample", **values) for _ in range(6000)]
    flood.write_bytes(b"".join(frames))
    with flood.open("rb") as file:
        os.dup2(file.fileno(), link.near.fileno())
    per_call = (1 << 16) // len(frames[0])
    assert link.read() == per_call and link.c.samples == per_call
    calls = 1
    while link.read() >= 0:  # a file that is read to its end is a device that is gone
        calls += 1
    assert calls == math.ceil(len(frames) * len(frames[0]) / (1 << 16))
    assert link.c.samples == len(frames) and link.c.sequence_gaps == link.c.crc_errors == 0
    with Path("/dev/zero").open("rb") as endless:
        os.dup2(endless.fileno(), link.near.fileno())
    assert link.read() == 0
