"""ODrive CAN Simple: every frame against the published databases, then drives as processes."""

import contextlib
import dataclasses
import functools
import math
import os
import re
import socket
import struct
import threading
import time
import tty
from importlib.resources import files
from pathlib import Path

import can
import cantools
import numpy as np
import pytest
from axis import Axis, add_options
from can.interfaces.udp_multicast import UdpMulticastBus
from line import arguments
from support.peer import peer, wait_until
from support.small import model_file, scene

from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.scene import Guard
from springpot.host.devices.can_bus import SocketBus, open_bus
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.odrive import (
    CLOSED_LOOP,
    ENCODER,
    Drive,
    DriveLimits,
    identifier,
    parse_heartbeat,
)
from springpot.host.devices.odrive_device import OdriveDevice, _transmission, require_fast_bus
from springpot.host.devices.url import parse_device
from springpot.host.emission.emission import emit
from springpot.host.native.loop_library import RESET, UNSENT, loop_library
from springpot.host.recording.session import open_press_device
from springpot.host.session.session import Session
from springpot.host.validation.validation import validate
from springpot.trainer.recordings.recording_file import read_recording

FILES = {"0.5": "odrive-cansimple-0.5.6.dbc", "0.6": "odrive-cansimple-0.6.10.dbc"}
TRAIN = "m_per_turn=0.1&max_torque_nm=1&nm_per_a=0.1"
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


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    base = tmp_path_factory.mktemp("scene")
    emit(scene(), model_file(base), base / "c")
    return base / "c"


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


def test_a_drive_without_watchdog_is_refused(folder):
    with peer("slcan_odrive", "--no-watchdog") as drive:
        with pytest.raises(DeviceError, match="watchdog on"):
            Session(folder, drive.url, report=list).__enter__()
        assert drive.wait_for("state", more=1)["state"] == 1  # left idle


@pytest.mark.parametrize(("firmware", "watchdog_ms"), [("0.5", 1350), ("0.6", 300)])
def test_a_drive_with_a_slow_watchdog_is_refused(firmware, watchdog_ms):
    """It would keep its torque for so long after the host has died."""
    options = ("--firmware", firmware, "--watchdog-ms", watchdog_ms)
    with peer("slcan_odrive", *options) as drive:
        says = r"keeps its torque .*\((0\.[3-9]|1\.).* s, at most 0\.2 s.*watchdog_timeout = 0\.05"
        with pytest.raises(DeviceError, match=says):
            OdriveDevice(parse_device(drive.url), DeviceRequirements(1000, 0.02, 12.0))
        assert not drive.named("zero"), "it was given a torque"


def test_a_watchdog_in_time_is_taken_at_the_default_heartbeat():
    with peer("slcan_odrive", "--watchdog-ms", 50) as drive:
        opened = OdriveDevice(parse_device(drive.url), DeviceRequirements(1000, 0.02, 12.0))
        opened.close()
        assert len(drive.named("tripped")) in (1, 2, 3)


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


@pytest.mark.parametrize("slcan", [True, False])
def test_limits_are_set_on_every_arming(family, link_of, slcan):
    name, database = family
    link = link_of(slcan=slcan, family=name)
    link.c.reset(link.c, 0)
    frames = dict(link.sent())
    told = database.decode_message("Axis0_Set_Limits", frames[0x0F])
    assert told == {"Velocity_Limit": 40.0, "Current_Limit": 5.0}
    assert list(frames).index(0x0F) < list(frames).index(0x07)


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


def test_the_wrong_node(folder):
    with peer("slcan_odrive", "--node", 5) as drive:
        url = drive.url.replace("node=5", "node=2")
        with pytest.raises(DeviceError, match=r"no heartbeat of node 2: heard nodes \[5\]"):
            Session(folder, url, report=list).__enter__()


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


def test_the_bus_is_too_slow_for_the_rate():
    with pytest.raises(DeviceError, match="250 kbit/s carry 926 exchanges a second, 1000 Hz need"):
        require_fast_bus("odrive://slcan//dev/x", 250_000, 1000)
    require_fast_bus("odrive://slcan//dev/x", 1_000_000, 1000)


@pytest.mark.parametrize(
    ("url", "error", "says"),
    [
        ("odrive://slcan//dev/none?node=0", UsageError, "m_per_turn is not known"),
        (f"odrive://slcan//dev/none?{TRAIN}", DeviceError, "no such port"),
        (f"odrive://slcan//dev/none?{TRAIN}&bitrate=250000", DeviceError, "250 kbit/s"),
        (f"odrive://slcan//dev/none?{TRAIN}&sign=0", UsageError, "sign"),
        (f"odrive://slcan//dev/none?{TRAIN}&speed=1", UsageError, "no setting 'speed'"),
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
