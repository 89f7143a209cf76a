"""How a serial device is asked, checked, started and proved, on a simulated clock and line."""

import contextlib
import math
import types
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise

import pytest
import serial
from cobs import cobs
from google_crc32c import value as crc32c
from support.messages import refusing

from springpot.codegen.errors import DeviceError, UsageError
from springpot.host.devices import device as device_module, serial_device
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.serial_device import SerialDevice
from springpot.host.devices.wire import Receiver, Sender, constant, layout

TRIPPED = constant("TRIPPED")


@dataclass
class SimulatedDevice:
    """The other end of the line, and the line: answers at once, samples at its rate."""

    max_n: float = 12.0
    layout: int = field(default_factory=layout)
    rate_hz: float = 1000.0
    trips_s: float = 0.05  # after the last force
    refuses: int = 0
    deaf: dict[str, int] = field(default_factory=dict)  # how many of each it does not hear
    noise: bytes = b""  # that comes with each reading
    version: int = 0
    gone: type[Exception] | None = None
    now_s: float = 50.0
    heard: list[tuple[str, dict, float]] = field(default_factory=list)
    closed: int = 0
    fd: int = 9
    forced_s: float = math.inf
    sampling_s: float = math.inf
    sent: bytes = b""
    slept: int = 0
    looked: int = 0

    def __post_init__(self) -> None:
        self._receiver, self._sender = Receiver(), Sender()

    def perf_counter(self) -> float:
        self.now_s += 1e-6
        return self.now_s

    def sleep(self, seconds: float) -> None:
        assert seconds == 0.0005  # between two looks the processor rests, and no sample is late
        self.slept += 1
        self.now_s += seconds

    def close(self) -> None:
        self.closed += 1

    def write(self, content: bytes) -> None:
        if self.gone is not None:
            raise self.gone("pulled out")
        for frame in self._receiver.feed(content):
            self.heard.append((frame.name, frame.values, self.now_s))
            left = self.deaf.get(frame.name, 0)
            self.deaf[frame.name] = left - 1
            if left <= 0:
                self._answer(frame.name, frame.sequence, frame.values)

    def _answer(self, name: str, sequence: int, values: dict) -> None:
        if name == "ask" and not self.version:
            self._say("hello", layout=self.layout, rate_hz=self.rate_hz, max_n=self.max_n)
        elif name == "ask":
            self.sent += of_version(self.version)
        elif name == "command":
            self._say("ack", command=sequence + 1, refused=0)  # of none that was sent
            self._say("ack", command=sequence, refused=self.refuses)
            self.forced_s = math.inf
            self.sampling_s = self.now_s
        elif name == "force":
            self.forced_s = self.now_s

    def _say(self, name: str, **values: object) -> None:
        self.sent += self._sender.encode(name, **values)

    def read(self, count: int) -> bytes:
        assert count == 4096
        self.looked += 1
        if self.gone is not None:
            raise self.gone("pulled out")
        if self.now_s > self.sampling_s and self.rate_hz > 0:
            status = TRIPPED if self.now_s > self.forced_s + self.trips_s else 0
            while self.sampling_s < self.now_s:
                self._say("sample", status=status, position_m=0.0, velocity_mps=0.0, measured_n=0.0)
                self.sampling_s += 1 / self.rate_hz
        content, self.sent = self.sent + self.noise, b""
        return content

    @property
    def names(self) -> list[str]:
        actions = {constant(name): name for name in ("STOP", "START", "RESET", "PRESS")}
        return [
            actions[values["action"]] if name == "command" else name
            for name, values, _ in self.heard
        ]


def of_version(version: int) -> bytes:
    """A whole frame of a protocol version, without a body."""
    plain = bytes([2, version, 0, 0, 0, 0])
    return b"\0" + cobs.encode(plain + crc32c(plain).to_bytes(4, "little")) + b"\0"


NEEDS = DeviceRequirements(1000, 0.15, 10.0)
Opened = Callable[..., SerialDevice]


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Opened:
    """Open the device behind a simulated line."""

    def made(
        simulated: SimulatedDevice, needs: DeviceRequirements = NEEDS, query: str = ""
    ) -> SerialDevice:
        clock = types.SimpleNamespace(perf_counter=simulated.perf_counter, sleep=simulated.sleep)
        monkeypatch.setattr(serial_device, "time", clock)
        monkeypatch.setattr(device_module, "time", clock)
        asked: list[tuple[str, int]] = []

        def open_port(place: str, baud: int) -> SimulatedDevice:
            asked.append((place, baud))
            return simulated

        monkeypatch.setattr(serial_device, "open_port", open_port)
        device = SerialDevice(parse_device(f"serial:///dev/none{query}"), needs)
        assert asked == [("/dev/none", 921600 if not query else 1_000_000)]
        return device

    return made


def require_refused(opened: Opened, simulated: SimulatedDevice, *parts: str, needs=NEEDS) -> None:
    with refusing(DeviceError, "serial:///dev/none: ", *parts):
        opened(simulated, needs)
    assert simulated.closed == 1


def test_a_device_is_asked_started_and_proved(opened: Opened) -> None:
    simulated = SimulatedDevice()
    device = opened(simulated)
    assert simulated.names == ["ask", "START", "force", "RESET"]
    assert simulated.heard[0][1] == {"layout": layout()}
    assert simulated.heard[2][1] == {"force_n": 0.0}
    for _, values, _ in (simulated.heard[1], simulated.heard[3]):
        assert values["watchdog_s"] == pytest.approx(0.15) and values["rate_hz"] == 1000.0
    assert simulated.closed == 0 and simulated.looked == simulated.slept > 0
    assert device.comes_back and device.failure == ""
    device.stop()
    assert simulated.names[4:] == ["ask", "STOP"]
    assert simulated._receiver.counts.crc_errors == simulated._receiver.counts.gaps == 0
    device.close()
    assert simulated.closed == 1


def test_an_object_is_pressed_with_another_command(opened: Opened) -> None:
    simulated = SimulatedDevice()
    opened(simulated, DeviceRequirements(1000, 0.15, 10.0, presses=True), "?baud=1000000")
    assert simulated.names == ["ask", "PRESS", "force", "RESET"]


@pytest.mark.parametrize(
    ("max_n", "watchdog_s", "asked_s"),
    [(10.0, 0.02, 0.02), (10.0, 0.15, 0.15), (10.0, 0.5, 0.15), (0.0, 0.5, 0.15)],
)
def test_no_watchdog_is_asked_for_that_could_not_be_proved(
    opened: Opened, max_n: float, watchdog_s: float, asked_s: float
) -> None:
    simulated = SimulatedDevice()
    device = opened(simulated, DeviceRequirements(1000, watchdog_s, max_n))
    assert device.watchdog_s == pytest.approx(asked_s)
    assert simulated.heard[1][1]["watchdog_s"] == pytest.approx(asked_s)


def test_what_is_not_heard_is_said_again_every_50_ms(opened: Opened) -> None:
    simulated = SimulatedDevice(deaf={"ask": 3, "command": 2})
    opened(simulated)
    assert simulated.names[:7] == ["ask"] * 4 + ["START"] * 3
    times = [when for _, _, when in simulated.heard[:4]]
    for before, after in pairwise(times):
        assert after - before == pytest.approx(0.05, abs=1e-3)


@pytest.mark.parametrize(
    ("options", "needs", "parts"),
    [
        ({"version": 9}, {}, ["version 9", "version 2", "flash"]),
        ({"layout": layout() ^ 1}, {}, [f"{layout() ^ 1:08x}", f"{layout():08x}"]),
        ({"refuses": 1}, {}, ["refuses START", "flash"]),
        ({"refuses": 2}, {}, ["refuses START at 1000 Hz", "runtime.rate_hz"]),
        ({"refuses": 3}, {}, ["150 ms", "guard.watchdog_ms"]),
        ({}, {"max_n": 12.0 * (1 + 1.2e-6)}, ["12 N", "guard.max_force_n = 12"]),
        ({"deaf": {"ask": 1000}, "sent": b"\3xx\0" * 3}, {}, ["no answer"]),
        ({"deaf": {"ask": 1000}, "sent": b"\3xx\0" * 4}, {}, ["damaged frames"]),
        ({"deaf": {"command": 1000}}, {}, ["START", "2 s", "restart"]),
        ({"rate_hz": 500.0}, {}, ["samples a second", "1000 Hz", "firmware"]),
        ({"trips_s": 0.25}, {}, ["after 0.25 s", "0.2 s"]),
        ({"trips_s": math.inf}, {}, ["never", "0.2 s"]),
    ],
)
def test_a_device_that_is_refused(opened: Opened, options: dict, needs: dict, parts: list) -> None:
    simulated = SimulatedDevice(**options)
    require_refused(opened, simulated, *parts, needs=replace(NEEDS, **needs))
    if "deaf" in options:
        assert simulated.now_s == pytest.approx(52.0, abs=5e-3)
    elif {"rate_hz", "trips_s"} & set(options):
        assert simulated.names[-2:] == ["ask", "STOP"]


def test_a_device_gives_the_scenes_force_to_a_millionth(opened: Opened) -> None:
    exact = next(n for n in range(1, 100) if n / (1 - 1e-6) * (1 - 1e-6) == n)
    for max_n, asked_n in ((12.0, 12.0 * (1 + 0.9e-6)), (exact, exact / (1 - 1e-6))):
        opened(SimulatedDevice(max_n=max_n), DeviceRequirements(1000, 0.15, asked_n))


def test_a_stop_waits_for_three_tenths_of_a_second_and_raises_nothing(opened: Opened) -> None:
    simulated = SimulatedDevice()
    device = opened(simulated)
    simulated.deaf["command"] = 1000
    begin_s = simulated.now_s
    device.stop()
    assert simulated.now_s - begin_s == pytest.approx(0.3, abs=2e-3)
    simulated.gone = OSError
    device.stop()
    for call in (device.frames, lambda: device.send("force", force_n=0.0)):
        with pytest.raises(DeviceError, match=r"went away \(pulled out\): plug it in"):
            call()
    simulated.gone = serial.SerialException
    with pytest.raises(DeviceError, match="went away"):
        device.frames()


@pytest.mark.parametrize(("trips_s", "proofs"), [(0.05, 1), (0.19, 1), (0.25, 3), (math.inf, 1)])
def test_a_watchdog_is_proved_three_times_at_most(
    opened: Opened, trips_s: float, proofs: int
) -> None:
    simulated = SimulatedDevice(trips_s=trips_s)
    with contextlib.nullcontext() if trips_s < 0.2 else pytest.raises(DeviceError):
        opened(simulated)
    assert simulated.names[2 : 2 + 2 * proofs] == ["force", "RESET"] * proofs
    assert simulated.names.count("force") == proofs


def test_the_link_gets_what_was_agreed(opened: Opened) -> None:
    simulated = SimulatedDevice()
    device = opened(simulated, DeviceRequirements(1000, 0.15, 10.0, surface_m=0.002))
    c = types.SimpleNamespace(sp_link_serial_size=lambda: 77, sp_link_serial_init=lambda *its: its)
    library = types.SimpleNamespace(memory=lambda size: ("memory", size), c=c)
    agreed = ("memory", 77), 9, pytest.approx(0.002), pytest.approx(0.15), 1000, 4
    assert device.link(library) == agreed
    for query in ("surface_mm=-10001", "baud=1199", "baud=12000001", "speed=1"):
        with pytest.raises(UsageError, match=r"give a number between|no setting"):
            SerialDevice(parse_device(f"serial:///dev/none?{query}"), NEEDS).link(library)
