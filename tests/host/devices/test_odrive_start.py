"""How a drive is heard, armed and proved, frame by frame, on a simulated clock."""

import contextlib
import dataclasses
import math
import struct
from dataclasses import dataclass, field
from unittest import mock

import pytest
from support.messages import refusing

from springpot.codegen.errors import DeviceError, UsageError
from springpot.host.devices import device as device_module, odrive, odrive_device
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.odrive import Drive, DriveLimits, Heartbeat, identifier, parse_heartbeat
from springpot.host.devices.odrive_device import OdriveDevice, Transmission, require_fast_bus

NODE = 5
CLEAR, LIMITS, MODE, STATE, TORQUE = 0x18, 0x0F, 0x0B, 0x07, 0x0E
CLOSED, IDLE = 8, 1
BITE = {"0.5": 0x800, "0.6": 0x1000000}  # of the watchdog, in the error word


@dataclass
class SimulatedDrive:
    """A bus with one drive on it: heartbeats on the tenth of a second, a watchdog, one version."""

    family: str = "0.6"
    watchdog_s: float = 0.05
    error: int = 0  # that no clearing takes away
    flags: bytes = bytes(3)
    arms: bool = True
    beats: bool = True
    bite: int | None = None  # what its watchdog says instead
    deaf: int = 0  # questions for its version that it misses
    heartbeat_s: float = 0.1
    others: tuple[tuple[int, bytes], ...] = ()  # frames that stand on the bus at the beginning
    estimates_hz: float = 0.0
    now_s: float = 100.0
    fd: int = 9
    failure: str = "pulled out"
    closed: int = 0
    state: int = IDLE
    code: int = 0
    fed_s: float = math.inf
    beat_s: float = 100.1
    sent: list[tuple[int, bytes, bool]] = field(default_factory=list)
    waiting: list[tuple[int, bytes]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.waiting = list(self.others)
        self.estimate_s = 100.0 if self.estimates_hz else math.inf

    def close(self) -> None:
        self.closed += 1

    def perf_counter(self) -> float:
        self.now_s += 1e-6
        return self.now_s

    def send(self, arbitration: int, data: bytes, *, remote: bool = False) -> None:
        assert arbitration >> 5 == NODE
        command = arbitration & 31
        self.sent.append((command, data, remote))
        self.fed_s = self.now_s
        if command == CLEAR:
            self.code = 0
        elif command == STATE:
            self.state = struct.unpack("<II", data)[0] if self.arms else IDLE
        elif command == 0 and remote and self.family == "0.6":
            self.deaf -= 1
            if self.deaf < 0:
                self.waiting.append((identifier(NODE, 0), bytes(8)))

    def receive(self, until_s: float) -> tuple[int, bytes] | None:
        self.now_s += 1e-6
        if self.waiting:
            return self.waiting.pop(0)
        off_s = self.fed_s + self.watchdog_s if self.state == CLOSED else math.inf
        if off_s < min(self.beat_s, until_s):
            self.state = IDLE
            self.code = BITE[self.family] if self.bite is None else self.bite
        if self.estimate_s < min(self.beat_s, until_s):
            self.now_s = max(self.now_s, self.estimate_s)
            self.estimate_s += 1 / self.estimates_hz
            return identifier(NODE, 9), bytes(8)
        if self.beat_s < until_s:
            self.now_s = max(self.now_s, self.beat_s)
            self.beat_s += self.heartbeat_s
            if self.beats:
                beat = struct.pack("<IB", self.code | self.error, self.state) + self.flags
                return identifier(NODE, 1), beat
            return self.receive(until_s)
        self.now_s = max(self.now_s, until_s)
        return None


@pytest.fixture
def drive_on(monkeypatch: pytest.MonkeyPatch):
    def made(simulated: SimulatedDrive, family: str | None = None) -> Drive:
        monkeypatch.setattr(odrive, "time", simulated)
        drive = Drive(simulated, NODE, "odrive://x", DriveLimits(40.0, 5.0))
        drive.family = simulated.family if family is None else family
        return drive

    return made


ARMING = [(CLEAR, bytes(8), False), (LIMITS, struct.pack("<ff", 40.0, 5.0), False),
          (MODE, struct.pack("<II", 1, 1), False), (TORQUE, bytes(8), False),
          (STATE, struct.pack("<II", 8, 0), False)]  # fmt: skip
NODES_3_AND_7 = tuple((identifier(node, 1), bytes(8)) for node in (7, 3, 7))
SILENT = {"beats": False, "estimates_hz": 0.0}
RESTING = [(TORQUE, bytes(8), False), (STATE, struct.pack("<II", 1, 0), False)]


def test_heartbeats_are_read_by_family() -> None:
    beat, faults = struct.pack("<IB", 0x01020304, 8), (b"\1\0\0", b"\0\1\0", b"\0\0\1")
    for flags in (bytes(3), *faults, b"\2\4\xfe"):
        flagged = flags in faults
        assert parse_heartbeat(beat + flags, "0.5") == Heartbeat(0x01020304, 8, flagged)
        assert parse_heartbeat(beat + flags, "0.6") == Heartbeat(0x01020304, 8, False)
    assert identifier(3, 9) == 0x69 and odrive.ENCODER == 0x09


@pytest.mark.parametrize("family", ["0.5", "0.6"])
def test_a_drive_whose_watchdog_is_short_is_made_ready(drive_on, family: str) -> None:
    simulated = SimulatedDrive(family)
    drive = drive_on(simulated, "")
    drive.make_ready()
    assert drive.family == family
    questions = [frame for frame in simulated.sent if frame[0] == 0]
    assert questions == [(0, b"", True)] * (1 if family == "0.6" else 3)
    commands = [frame for frame in simulated.sent if frame[0] != 0]
    assert commands[:5] == ARMING  # once, then only torques of zero, then silence
    assert set(commands[5:]) == {(TORQUE, bytes(8), False)}
    assert simulated.state == IDLE and simulated.now_s < 101.0


@pytest.mark.parametrize("deaf", [0, 1, 2, 3])
def test_an_answer_for_the_version_may_be_lost_twice(drive_on, deaf: int) -> None:
    simulated = SimulatedDrive("0.6", deaf=deaf, beat_s=math.inf)
    assert drive_on(simulated)._firmware() == ("0.6" if deaf < 3 else "0.5")
    assert len(simulated.sent) == min(deaf + 1, 3)
    assert simulated.now_s == pytest.approx(100.0 + 0.1 * deaf, abs=1e-3)


ALL = "m_per_turn=0.05&max_torque_nm=0.4&nm_per_a=0.04"
NEEDS = DeviceRequirements(1000, 0.02, 12.0)


def transmission(query: str = ALL, needs: DeviceRequirements = NEEDS) -> Transmission:
    return odrive_device._transmission(parse_device(f"odrive://slcan//dev/x?{query}"), needs)


def test_a_transmission_is_that_of_the_address_or_the_scene() -> None:
    stated = {"m_per_turn": 0.05, "sign": -1, "max_torque_nm": 0.4, "nm_per_a": 0.04}
    scene = dataclasses.replace(NEEDS, surface_m=0.003, zero_turns=0.25, **stated)
    assert transmission("", scene) == Transmission(0.05, -1, 0.25, 0.003, 0.4, 0.04)
    query = "m_per_turn=0.06&sign=1&zero_turns=-3&surface_mm=-7&max_torque_nm=0.5&nm_per_a=0.05"
    assert transmission(query, scene) == Transmission(0.06, 1, -3.0, -0.007, 0.5, 0.05)
    assert (found := transmission()) == Transmission(0.05, 1, 0.0, 0.0, 0.4, 0.04)
    assert found.max_n == pytest.approx(0.4 * 2 * math.pi / 0.05, rel=1e-12)
    assert found.limits.turns_per_s == pytest.approx(2 / 0.05 + 6 * 0.4 + 20)
    assert found.limits.current_a == pytest.approx(1.05 * 0.4 / 0.04)


@pytest.mark.parametrize(
    ("query", "told"),
    [("max_torque_nm=0.4&nm_per_a=0.04", "m_per_turn"),
     ("m_per_turn=0.05&nm_per_a=0.04", "max_torque_nm"),
     ("m_per_turn=0.05&max_torque_nm=0.4", "nm_per_a"),
     *((f"{ALL}&{query}", told) for query, told in (
         ("m_per_turn=100.1", "between 0 and 100"), ("max_torque_nm=10001", "between 0 and 10000"),
         ("nm_per_a=10001", "between 0 and 10000"), ("nm_per_a=-1", "between 0 and 10000"),
         ("sign=0.5", "give 1 or -1"), ("sign=2", "between -1 and 1"),
         ("zero_turns=1000001", "between -1000000 and 1000000"),
         ("surface_mm=100001", "between -100000 and"), ("node=64", "between 0 and 63"),
         ("surface_mm=-100001", "between -100000 and"), ("node=-1", "between 0 and 63"),
         ("bitrate=9999", "between 10000 and 1000000"), ("speed=1", "no setting 'speed'"),
         ("bitrate=1000001", "between 10000 and 1000000"),
     ))],
)  # fmt: skip
def test_settings_of_a_drive_are_checked_before_its_port_is_opened(query: str, told: str) -> None:
    with refusing(UsageError, query.removeprefix(f"{ALL}&")[:5], told):
        OdriveDevice(parse_device(f"odrive://slcan//dev/none?{query}"), NEEDS)


def test_the_last_numbers_of_a_transmission_are_taken() -> None:
    for turns, surface_mm in ((1e6, 1e5), (-1e6, -1e5)):
        found = transmission(f"{ALL}&zero_turns={turns}&surface_mm={surface_mm}&sign=-1")
        assert (found.zero_turns, found.surface_m, found.sign) == (turns, surface_mm / 1e3, -1)
    weak = DeviceRequirements(1000, 0.02, 0.0)
    found = transmission("m_per_turn=100&max_torque_nm=10000&nm_per_a=10000", weak)
    assert (found.m_per_turn, found.max_torque_nm, found.nm_per_a) == (100, 10000, 10000)


def test_a_motor_gives_the_scenes_force_to_a_millionth() -> None:
    max_n = transmission().max_n
    for more, fits in ((1 + 0.9e-6, True), (1 + 1.1e-6, False)):
        refuses = pytest.raises(DeviceError, match=r"0\.4 Nm give 50\.2 N and the scene up to")
        with contextlib.nullcontext() if fits else refuses:
            assert transmission(ALL, DeviceRequirements(1000, 0.02, max_n * more)).max_n == max_n


def test_a_bus_carries_two_frames_a_tick() -> None:
    require_fast_bus("x", 270_000, 1000)
    with refusing(DeviceError, "x: 269.999 kbit/s", "1000 Hz", "270 kbit/s"):
        require_fast_bus("x", 269_999, 1000)


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch):
    def made(simulated: SimulatedDrive, needs=NEEDS, url: str = "socketcan/can0") -> OdriveDevice:
        for module in (odrive, odrive_device, device_module):
            monkeypatch.setattr(module, "time", simulated)
        address = parse_device(f"odrive://{url}?node=5&{ALL}")
        bus = mock.Mock(return_value=simulated)
        monkeypatch.setattr(odrive_device, "CanBus", bus)
        try:
            return OdriveDevice(address, needs)
        finally:
            bus.assert_called_once_with(address, 1_000_000)

    return made


@pytest.mark.parametrize("family", ["0.5", "0.6"])
def test_a_drive_is_opened_and_its_link_gets_what_was_agreed(opened, family: str) -> None:
    simulated = SimulatedDrive(family, estimates_hz=1000.0)
    needs = dataclasses.replace(NEEDS, sign=-1, zero_turns=0.25, surface_m=0.003)
    device = opened(simulated, needs)
    assert device.comes_back and device.failure == "pulled out"
    library = mock.Mock()
    library.ffi.new = library.c.sp_link_odrive_init = lambda *its: its
    library.memory = lambda size: ("memory", size)
    library.c.sp_link_odrive_size.return_value = 77
    settings = {
        "node": 5, "with_torque": int(family == "0.6"), "m_per_turn": 0.05, "sign": -1,
        "zero_turns": 0.25, "surface_m": 0.003, "max_torque_nm": 0.4,
        "max_turns_per_s": pytest.approx(62.4), "max_current_a": pytest.approx(10.5),
    }  # fmt: skip
    assert device.link(library) == (("memory", 77), 9, ("sp_odrive *", settings))
    simulated.sent.clear()
    device.stop()
    assert simulated.sent == RESTING and simulated.closed == 0
    device.close()
    assert simulated.closed == 1
    simulated.send = mock.Mock(side_effect=DeviceError("gone"))
    device.stop()  # its watchdog does it


@pytest.mark.parametrize(
    ("fault", "rate_hz", "told"),
    [(SILENT, 1000, ["no heartbeat of node 5", "?bitrate="]),
     ({**SILENT, "others": NODES_3_AND_7}, 1000, ["heard nodes [3, 7]: use ?node="]),
     *((stuck, 1000, [*told, "calibrate"]) for stuck, told in (
         ({"arms": False}, ["node 5", "state 1, error 0x0"]),
         ({"arms": False, "error": 0x40}, ["node 5", "state 1, error 0x40"]),
         ({"error": 0x40}, ["node 5", "state 8, error 0x40"]),
         ({"flags": b"\0\1\0", "family": "0.5"}, ["state 8, error 0x0"]),
     )),
     *(({"watchdog_s": s}, 1000, ["node 5", after, "0.2 s"])
       for s, after in ((math.inf, "never"), (0.33, "0.41 s"))),
     *(({"family": family, "bite": bite}, 1000, [f"switched itself off with error 0x{bite:x}"])
       for family, others in (("0.5", BITE["0.6"]), ("0.6", BITE["0.5"]))
       for bite in (0, 1, 0x40, others)),
     *((family, hz, ["samples a second", *told]) for family, hz, told in (
         ({"family": "0.5"}, 500, ["500 Hz", "encoder_rate_ms = 2`"]),
         ({}, 500, ["500 Hz", "encoder_msg_rate_ms = 2`"]),
         ({}, 1000, ["1000 Hz", "encoder_msg_rate_ms = 1`"]),
         ({}, 1001, ["1000 a second: set runtime.rate_hz"]),
     ))],
)  # fmt: skip
def test_a_drive_that_cannot_be_used_is_closed_and_told(
    opened, fault: dict, rate_hz: float, told: list[str]
) -> None:
    simulated = SimulatedDrive(**{"estimates_hz": 250.0, **fault})
    with refusing(DeviceError, *told):
        opened(simulated, dataclasses.replace(NEEDS, rate_hz=rate_hz))
    assert simulated.closed == 1
    assert {data for command, data, _ in simulated.sent if command == TORQUE} <= {bytes(8)}
    if "watchdog_s" in fault:
        assert simulated.sent[-2:] == RESTING
    if "arms" in fault or "beats" in fault:
        assert simulated.now_s == pytest.approx(102.0, abs=0.5)


def test_what_has_waited_is_no_rate(opened, monkeypatch: pytest.MonkeyPatch) -> None:
    make_ready, waited = Drive.make_ready, [(identifier(NODE, 9), bytes(8))] * 300

    def ready(drive: Drive) -> None:
        make_ready(drive)
        drive.bus.waiting += waited

    monkeypatch.setattr(Drive, "make_ready", ready)
    with refusing(DeviceError, "samples a second"):
        opened(SimulatedDrive(estimates_hz=250.0), NEEDS)


def test_a_slow_adapter_is_refused_before_it_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(odrive_device, "require_port", lambda _place: None)
    slow = mock.Mock(side_effect=DeviceError("slow"))
    monkeypatch.setattr(odrive_device, "require_fast_adapter", slow)
    for more, told in (("", "slow"), ("&bitrate=250000", "250 kbit/s")):
        with pytest.raises(DeviceError, match=told):
            OdriveDevice(parse_device(f"odrive://slcan//dev/x?{ALL}{more}"), NEEDS)
    slow.assert_called_once_with("/dev/x", 1000)
