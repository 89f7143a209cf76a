"""The C link of an ODrive: every frame of CAN Simple against the published databases."""

import contextlib
import functools
import math
import os
import socket
import struct
import threading
import tty
from importlib.resources import files
from pathlib import Path

import cantools
import numpy as np
import pytest

from springpot.host.devices.odrive import (
    CLOSED_LOOP,
    ENCODER,
    parse_heartbeat,
)
from springpot.host.native.loop_library import loop_library

FILES = {"0.5": "odrive-cansimple-0.5.6.dbc", "0.6": "odrive-cansimple-0.6.10.dbc"}
NODE = 3


@pytest.fixture(scope="module", params=list(FILES))
def family(request):
    text = files("odrive_can").joinpath("dbc", FILES[request.param]).read_text()
    return request.param, cantools.database.load_string(text, "dbc")


@pytest.fixture
def link_of():
    """Make C links that are closed at the end."""
    with contextlib.ExitStack() as stack:
        yield lambda **options: stack.enter_context(CLink(**options))


class CLink:
    """The C link of a drive on a socket pair: what the loop does, one call at a time."""

    def __init__(self, *, slcan: bool, family: str, sign: int = 1, node: int = 0) -> None:
        self.library = loop_library("double")
        kind = socket.SOCK_STREAM if slcan else socket.SOCK_SEQPACKET
        self.far, self.near = socket.socketpair(socket.AF_UNIX, kind)
        self.near.setblocking(False)
        self.far.setblocking(False)
        settings = self.library.ffi.new("sp_odrive *", {
            "node": node, "slcan": slcan, "with_torque": family == "0.6", "m_per_turn": 0.05,
            "sign": sign, "zero_turns": 0.5, "surface_m": 0.002, "max_torque_nm": 0.5,
            "max_turns_per_s": 40.0, "max_current_a": 5.0,
        })  # fmt: skip
        self.memory = self.library.memory(self.library.c.sp_link_odrive_size())
        self.c = self.library.c.sp_link_odrive_init(self.memory, self.near.fileno(), settings)
        self.motion = self.library.ffi.new("sp_motion *")
        self.slcan = slcan

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.near.close()
        self.far.close()

    def give(self, found: int, data: bytes) -> None:
        if self.slcan:
            self.far.send(f"t{found:03X}{len(data)}{data.hex().upper()}\r".encode())
        else:
            self.far.send(struct.pack("=IB3x8s", found, len(data), data))

    def read(self) -> int:
        return self.c.read(self.c, 0, self.motion, 1)

    def sent(self) -> list[tuple[int, bytes]]:
        content = self.far.recv(65536) if self.slcan else b""
        if self.slcan:
            return [(int(line[1:4], 16), bytes.fromhex(line[5:].decode()))
                    for line in content.split(b"\r") if line]  # fmt: skip
        found = []
        while True:
            try:
                number, size, data = struct.unpack("=IB3x8s", self.far.recv(16))
            except BlockingIOError:
                return found
            found.append((number, data[:size]))


@pytest.mark.parametrize(("slcan", "per_call"), [(True, (1 << 16) // 22), (False, 512)])
def test_a_flooded_bus_does_not_keep_a_tick(link_of, tmp_path, slcan, per_call):
    """64 KiB of text or 512 frames a call; what is more comes with the next ones."""
    link = link_of(slcan=slcan, family="0.5")
    one = b"t0098" + bytes(8).hex().encode() + b"\r"
    one = one if slcan else struct.pack("=IB3x8s", ENCODER, 8, bytes(8))
    flood = tmp_path / "flood"
    flood.write_bytes(one * 4000)
    with flood.open("rb") as file:
        os.dup2(file.fileno(), link.near.fileno())
    assert link.read() == per_call
    while link.read() >= 0:  # a file that is read to its end is a bus that is gone
        pass
    assert link.c.samples == 4000
    assert link.c.crc_errors == 0
    with Path("/dev/zero").open("rb") as endless:
        os.dup2(endless.fileno(), link.near.fileno())
    assert link.read() == 0


@pytest.mark.parametrize("slcan", [True, False])
@pytest.mark.parametrize("sign", [1, -1])
def test_position_and_torque_against_the_database(family, link_of, slcan, sign):
    name, database = family
    link = link_of(slcan=slcan, family=name, sign=sign)
    estimate = database.get_message_by_name("Axis0_Get_Encoder_Estimates")
    torque = database.get_message_by_name("Axis0_Set_Input_Torque")
    for turns, speed in ((0.75, -2.0), (-1.25, 0.5), (0.5, 0.0)):
        data = estimate.encode({"Pos_Estimate": turns, "Vel_Estimate": speed})
        link.give(estimate.frame_id, data)
        assert link.read() == 1
        assert link.motion.position_m == sign * (turns - 0.5) * 0.05 - 0.002
        assert link.motion.velocity_mps == sign * speed * 0.05
        assert math.isnan(link.motion.measured_n)
    for force_n in (3.5, -2.0, 0.0):
        assert link.c.write(link.c, 0, force_n) == 0
        ((found, data),) = link.sent()
        assert found == torque.frame_id
        told = torque.decode(data)["Input_Torque"]
        assert told == pytest.approx(-sign * force_n * 0.05 / (2 * math.pi), rel=1e-6)
    assert link.c.write(link.c, 0, 100.0) == -2  # more than the motor may give: nothing is sent


@pytest.mark.parametrize("slcan", [True, False])
def test_arming_heartbeats_and_torques(family, link_of, slcan):
    name, database = family
    link = link_of(slcan=slcan, family=name)
    link.c.reset(link.c, 0)
    frames = dict(link.sent())
    decode = functools.partial(database.decode_message, decode_choices=False)
    assert decode("Axis0_Set_Axis_State", frames[0x07])["Axis_Requested_State"] == CLOSED_LOOP
    mode = decode("Axis0_Set_Controller_Mode", frames[0x0B])
    assert (int(mode["Control_Mode"]), int(mode["Input_Mode"])) == (1, 1)
    assert 0x18 in frames
    limits = decode("Axis0_Set_Limits", frames[0x0F])
    assert limits == {"Velocity_Limit": 40.0, "Current_Limit": 5.0}
    assert list(frames).index(0x0F) < list(frames).index(0x07)
    assert link.c.ready == 0

    heartbeat = database.get_message_by_name("Axis0_Heartbeat")

    def beat(state: int, error: int = 0, **more: int) -> bytes:
        values = {signal.name: 0 for signal in heartbeat.signals}
        return heartbeat.encode({**values, "Axis_State": state, "Axis_Error": error, **more})

    link.give(1, beat(1))
    assert link.read() == 0  # not armed yet: no trip
    link.give(1, beat(CLOSED_LOOP, Trajectory_Done_Flag=1))
    assert link.read() == 0
    assert link.c.ready == 1
    assert parse_heartbeat(beat(8, Trajectory_Done_Flag=1), name).failed is False
    if name == "0.5":
        link.give(1, beat(CLOSED_LOOP, Encoder_Error_Flag=1))
        assert parse_heartbeat(beat(8, Encoder_Error_Flag=1), name).failed is True
    else:
        link.give(1, beat(CLOSED_LOOP, Procedure_Result=3))
        assert link.read() == 0
        link.give(1, beat(1, error=0x1000000))
    assert link.read() == -2
    # 0x1C are torques in 0.6 and something else in 0.5
    link = link_of(slcan=slcan, family=name)
    link.give(0x1C, struct.pack("<ff", 0.1, 0.2))
    link.give(0x09, struct.pack("<ff", 0.0, 0.0))
    assert link.read() == 1
    if name == "0.6":
        message = database.get_message_by_name("Axis0_Get_Torques")
        assert message.frame_id == 0x1C
        told = message.decode(struct.pack("<ff", 0.1, 0.2))["Torque_Estimate"]
        assert link.motion.measured_n == pytest.approx(told * 2 * math.pi / 0.05)
    else:
        assert math.isnan(link.motion.measured_n)


@pytest.mark.parametrize("flag", [0x80000000, 0x40000000, 0x20000000])
def test_only_data_frames_with_short_identifiers_are_samples(link_of, flag):
    """Extended, remote and error frames of a socket are none; nor is one that is too short."""
    link, data = link_of(slcan=False, family="0.6"), struct.pack("<ff", 1.0, 2.0)
    link.give(flag | ENCODER, data)
    link.give(ENCODER, data[:7])
    link.far.send(b"short")
    assert link.read() == 0
    link.give(ENCODER, data)
    assert link.read() == 1


def test_other_nodes_and_damaged_lines_are_no_samples(link_of):
    link = link_of(slcan=True, family="0.6", node=NODE)
    good = f"t{NODE << 5 | 9:03X}8{struct.pack('<ff', 1.0, 2.0).hex().upper()}\r".encode()
    rng = np.random.default_rng(3)
    wrong = 0
    for _ in range(20_000):
        content = bytearray(good)
        match int(rng.integers(0, 4)):
            case 0:
                content = content[: rng.integers(0, len(content) - 1)]  # its end is lost
            case 1:
                del content[int(rng.integers(0, len(content) - 1))]
            case 2:
                content = bytearray(rng.integers(128, 256, 30, dtype=np.uint8).tobytes())
            case _:
                content[1] = ord("7")  # another node
        link.far.send(bytes(content) + b"\r")
        before = link.c.samples
        link.read()
        wrong += link.c.samples > before and link.motion.position_m != (1.0 - 0.5) * 0.05 - 0.002
        link.far.send(good)
        assert link.read() == 1
        assert link.motion.velocity_mps == 2.0 * 0.05
    assert wrong == 0
    assert link.c.crc_errors > 5000


def test_the_greatest_force_is_sent_whatever_the_rounding(link_of):
    """A session is let in to a millionth, and its forces are float32: never a trip at the limit."""
    rng = np.random.default_rng(7)
    link = link_of(slcan=False, family="0.6")
    drive = link.library.ffi.new("sp_odrive *", {"slcan": 0})
    for _ in range(2000):
        max_nm, m_per_turn = float(10 ** rng.uniform(-2, 1)), float(10 ** rng.uniform(-3, 0))
        drive.max_torque_nm, drive.m_per_turn = max_nm, m_per_turn
        drive.sign = float(rng.choice([-1.0, 1.0]))
        link.c = link.library.c.sp_link_odrive_init(link.memory, link.near.fileno(), drive)
        max_n = float(np.float32(max_nm * 2 * math.pi / m_per_turn * (1 + 1e-6)))
        for force_n in (max_n, -max_n):
            assert link.c.write(link.c, 0, force_n) == 0
        sent = [struct.unpack_from("<f", data)[0] for _, data in link.sent()]
        assert sent == [-drive.sign * np.float32(max_nm), drive.sign * np.float32(max_nm)]
        assert link.c.write(link.c, 0, 1.0001 * max_n) == -2


def test_a_line_that_was_cut_is_ended_as_it_began(link_of):
    """Some adapters take a line that is too short for a frame: none is ever sent."""
    link, got, put = link_of(slcan=True, family="0.6"), b"", []
    far, near = os.openpty()
    tty.setraw(near)
    os.set_blocking(near, False)
    link.c.fd = near
    for _ in range(20):
        while not put or put[-1] == 0:  # until there is no room
            put.append(link.c.write(link.c, 0, len(put) % 50 / 10))
        got += os.read(far, 100 + len(put) % 7)
        put.append(0)
    os.set_blocking(near, True)

    def finish() -> None:
        assert link.c.write(link.c, 0, 0.0) == 0
        os.write(near, b"end\r")

    last = threading.Thread(target=finish)
    last.start()
    while not got.endswith(b"end\r"):
        got += os.read(far, 65536)
    last.join()
    *lines, end, nothing = got.split(b"\r")
    assert (end, nothing) == (b"end", b"")
    assert put.count(1) >= 20
    assert len(lines) > 200
    assert {(len(line), line[:5]) for line in lines} == {(21, b"t00E8")}
    os.close(far)
    os.close(near)
