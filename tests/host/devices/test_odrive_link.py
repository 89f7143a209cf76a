"""The C link of an ODrive: every frame of CAN Simple against the published databases."""

import contextlib
import functools
import math
import os
import socket
import struct
from importlib.resources import files
from pathlib import Path

import cantools
import numpy as np
import pytest

from springpot.host.devices.odrive import CLOSED_LOOP, ENCODER, parse_heartbeat
from springpot.host.native.c_library import loop_library

FILES = {"0.5": "odrive-cansimple-0.5.6.dbc", "0.6": "odrive-cansimple-0.6.10.dbc"}


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

    def __init__(self, *, family: str, sign: int = 1, node: int = 0) -> None:
        self.library = loop_library("double")
        self.far, self.near = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.near.setblocking(False)
        self.far.setblocking(False)
        settings = self.library.ffi.new("sp_odrive *", {
            "node": node, "with_torque": family == "0.6", "m_per_turn": 0.05,
            "sign": sign, "zero_turns": 0.5, "surface_m": 0.002, "max_torque_nm": 0.5,
            "max_turns_per_s": 40.0, "max_current_a": 5.0,
        })  # fmt: skip
        self.memory = self.library.memory(self.library.c.sp_link_odrive_size())
        self.c = self.library.c.sp_link_odrive_init(self.memory, self.near.fileno(), settings)
        self.motion = self.library.ffi.new("sp_motion *")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.near.close()
        self.far.close()

    def give(self, found: int, data: bytes) -> None:
        self.far.send(struct.pack("=IB3x8s", found, len(data), data))

    def read(self) -> int:
        return self.c.read(self.c, 0, self.motion, 1)

    def sent(self) -> list[tuple[int, bytes]]:
        found = []
        while True:
            try:
                number, size, data = struct.unpack("=IB3x8s", self.far.recv(16))
            except BlockingIOError:
                return found
            found.append((number, data[:size]))


def test_a_flooded_bus_does_not_keep_a_tick(link_of, tmp_path):
    """512 frames a call; what is more comes with the next ones."""
    link, flood = link_of(family="0.5"), tmp_path / "flood"
    flood.write_bytes(struct.pack("=IB3x8s", ENCODER, 8, bytes(8)) * 4000)
    with flood.open("rb") as file:
        os.dup2(file.fileno(), link.near.fileno())
    assert link.read() == 512
    while link.read() >= 0:  # a file that is read to its end is a bus that is gone
        pass
    assert link.c.samples == 4000 and link.c.crc_errors == 0
    with Path("/dev/zero").open("rb") as endless:
        os.dup2(endless.fileno(), link.near.fileno())
    assert link.read() == 0


@pytest.mark.parametrize("sign", [1, -1])
def test_position_and_torque_against_the_database(family, link_of, sign):
    name, database = family
    link = link_of(family=name, sign=sign)
    estimate = database.get_message_by_name("Axis0_Get_Encoder_Estimates")
    torque = database.get_message_by_name("Axis0_Set_Input_Torque")
    for turns, speed in ((0.75, -2.0), (-1.25, 0.5), (0.5, 0.0)):
        data = estimate.encode({"Pos_Estimate": turns, "Vel_Estimate": speed})
        link.give(estimate.frame_id, data)
        assert link.read() == 1 and link.motion.position_m == sign * (turns - 0.5) * 0.05 - 0.002
        assert link.motion.velocity_mps == sign * speed * 0.05
        assert math.isnan(link.motion.measured_n)
    for force_n in (3.5, -2.0, 0.0):
        assert link.c.write(link.c, 0, force_n) == 0
        ((found, data),) = link.sent()
        assert found == torque.frame_id
        told = torque.decode(data)["Input_Torque"]
        assert told == pytest.approx(-sign * force_n * 0.05 / (2 * math.pi), rel=1e-6)
    assert link.c.write(link.c, 0, 100.0) == -2  # more than the motor may give: nothing is sent


def test_arming_heartbeats_and_torques(family, link_of):
    name, database = family
    link = link_of(family=name)
    link.c.reset(link.c, 0)
    frames = dict(link.sent())
    decode = functools.partial(database.decode_message, decode_choices=False)
    assert decode("Axis0_Set_Axis_State", frames[0x07])["Axis_Requested_State"] == CLOSED_LOOP
    mode = decode("Axis0_Set_Controller_Mode", frames[0x0B])
    assert (int(mode["Control_Mode"]), int(mode["Input_Mode"])) == (1, 1) and 0x18 in frames
    limits = decode("Axis0_Set_Limits", frames[0x0F])
    assert limits == {"Velocity_Limit": 40.0, "Current_Limit": 5.0}
    assert list(frames).index(0x0F) < list(frames).index(0x07) and link.c.ready == 0

    heartbeat = database.get_message_by_name("Axis0_Heartbeat")

    def beat(state: int, error: int = 0, **more: int) -> bytes:
        values = {signal.name: 0 for signal in heartbeat.signals}
        return heartbeat.encode({**values, "Axis_State": state, "Axis_Error": error, **more})

    link.give(1, beat(1))
    assert link.read() == 0  # not armed yet: no trip
    link.give(1, beat(CLOSED_LOOP, Trajectory_Done_Flag=1))
    assert link.read() == 0 and link.c.ready == 1
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
    link = link_of(family=name)
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
    link, data = link_of(family="0.6"), struct.pack("<ff", 1.0, 2.0)
    link.give(flag | ENCODER, data)
    link.give(ENCODER, data[:7])
    link.give(7 << 5 | ENCODER, data)  # of another node
    link.far.send(b"short")
    assert link.read() == 0
    link.give(ENCODER, data)
    assert link.read() == 1


def test_the_greatest_force_is_sent_whatever_the_rounding(link_of):
    """A session is let in to a millionth, and its forces are float32: never a trip at the limit."""
    rng, link = np.random.default_rng(7), link_of(family="0.6")
    drive = link.library.ffi.new("sp_odrive *")
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
