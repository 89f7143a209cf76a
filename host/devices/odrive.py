"""ODrive CAN Simple: what frames mean, and how a drive is made ready. Both firmware families."""

import math
import struct
import time
from dataclasses import dataclass

from springpot.codegen.errors import DeviceError
from springpot.host.devices.can_bus import CanBus
from springpot.host.devices.device import ZERO_S, proved_watchdog_s

VERSION, HEARTBEAT, AXIS_STATE, ENCODER, CONTROLLER_MODE = 0x00, 0x01, 0x07, 0x09, 0x0B
INPUT_TORQUE, LIMITS, CLEAR_ERRORS = 0x0E, 0x0F, 0x18
AXIS_IDLE, CLOSED_LOOP = 1, 8
_TORQUE_CONTROL, _PASSTHROUGH = 1, 1
# Of the heartbeat's error word: the watchdog's bit in each family.
_WATCHDOG = {"0.5": 0x800, "0.6": 0x1000000}
_HEARD_S, _ARMED_S, _PROOF_S, _FEED_S = 2.0, 2.0, 1.5, 0.005
_QUESTIONS, _ANSWER_S = 3, 0.1


@dataclass(frozen=True)
class Heartbeat:
    """State that a drive sends about ten times a second. failed: flags beside the error word."""

    error: int
    state: int
    failed: bool


def parse_heartbeat(data: bytes, family: str) -> Heartbeat:
    """Read a heartbeat of firmware family "0.5" or "0.6"; bytes 5 to 7 differ between them.

    0.5: flags of motor, encoder and controller errors. 0.6: the result of a procedure.
    """
    error, state = struct.unpack_from("<IB", data)
    failed = family == "0.5" and bool((data[5] | data[6] | data[7]) & 1)
    return Heartbeat(error, state, failed)


def identifier(node: int, command: int) -> int:
    """Arbitration identifier of a command."""
    return node << 5 | command


@dataclass(frozen=True)
class DriveLimits:
    """Limits of the motor: beyond them the drive gives less torque than asked for, or none."""

    turns_per_s: float
    current_a: float


class Drive:
    """One axis on a bus, before the loop takes over."""

    def __init__(self, bus: CanBus, node: int, url: str, limits: DriveLimits) -> None:
        self.bus, self.node, self.url, self.limits = bus, node, url, limits
        self.family = ""
        self._fed_s = 0.0  # the last command went out

    def make_ready(self) -> None:
        """Find the drive and its firmware, and prove that it can be armed and has a watchdog.

        The proof: the drive is armed without force and left without commands; a drive that does not
        say in time that it switched itself off is refused. The loop arms it again when it starts.
        Raises DeviceError.
        """
        self._hear()
        self.family = self._firmware()
        self._prove_watchdog()

    def arm(self) -> None:
        """Clear errors, limits, torque control, closed loop; zero torque is sent meanwhile."""
        self.ask_for_torque_control()
        until, state = time.perf_counter() + _ARMED_S, ""
        while time.perf_counter() < until:
            self.torque(0.0)
            beat = self._heartbeat(time.perf_counter() + _FEED_S)
            if beat is not None and beat.state == CLOSED_LOOP and not (beat.error or beat.failed):
                return
            if beat is not None:
                state = f"state {beat.state}, error 0x{beat.error:x}"
        raise DeviceError(
            f"{self.url}: node {self.node} does not go to closed loop ({state or 'it is silent'}): "
            "calibrate it and clear its errors with odrivetool (`dump_errors(odrv0)`)"
        )

    def ask_for_torque_control(self) -> None:
        """Clear errors, limits, torque control, closed loop; the heartbeat says when it is
        ready."""
        self.send(CLEAR_ERRORS, b"\0" * 8)
        self.send(LIMITS, struct.pack("<ff", self.limits.turns_per_s, self.limits.current_a))
        self.send(CONTROLLER_MODE, struct.pack("<II", _TORQUE_CONTROL, _PASSTHROUGH))
        self.torque(0.0)
        self.send(AXIS_STATE, struct.pack("<II", CLOSED_LOOP, 0))

    def rest(self) -> None:
        """No torque, and the axis idle."""
        self.torque(0.0)
        self.send(AXIS_STATE, struct.pack("<II", AXIS_IDLE, 0))

    def torque(self, torque_nm: float) -> None:
        """Send a torque, Nm; it feeds the drive's watchdog."""
        self.send(INPUT_TORQUE, struct.pack("<f4x", torque_nm))

    def send(self, command: int, data: bytes, *, remote: bool = False) -> None:
        self._fed_s = time.perf_counter()
        self.bus.send(identifier(self.node, command), data, remote=remote)

    def _hear(self) -> None:
        """Wait for the drive's heartbeat. Raises DeviceError naming those heard."""
        heard: set[int] = set()
        until = time.perf_counter() + _HEARD_S
        while (frame := self.bus.receive(until)) is not None:
            heard.add(frame[0] >> 5)
            if frame[0] == identifier(self.node, HEARTBEAT):
                return
        others = f"heard nodes {sorted(heard)}: use ?node=" if heard else "the bus is silent: "
        others += "" if heard else "check power, wiring, termination, ?bitrate= and the adapter"
        raise DeviceError(f"{self.url}: no heartbeat of node {self.node}: {others}")

    def _firmware(self) -> str:
        """0.6 answers a question for its version, 0.5 does not know it; an answer may get lost."""
        for _ in range(_QUESTIONS):
            self.send(VERSION, b"", remote=True)
            until = time.perf_counter() + _ANSWER_S
            while (frame := self.bus.receive(until)) is not None:
                if frame[0] == identifier(self.node, VERSION) and len(frame[1]) == 8:
                    return "0.6"
        return "0.5"

    def _heartbeat(self, until_s: float) -> Heartbeat | None:
        newest = None
        while (frame := self.bus.receive(until_s)) is not None:
            if frame[0] == identifier(self.node, HEARTBEAT) and len(frame[1]) == 8:
                newest = parse_heartbeat(frame[1], self.family)
        return newest

    def _prove_watchdog(self) -> None:
        """Raise DeviceError for a drive that keeps its torque without commands."""
        found_s = proved_watchdog_s(self._silent_until_off_s)
        if found_s <= ZERO_S:
            return
        self.rest()
        reaction = "never" if math.isinf(found_s) else f"{found_s:.2f} s"
        raise DeviceError(
            f"{self.url}: node {self.node} keeps its torque without commands ({reaction}, at most "
            f"{ZERO_S:g} s are accepted): switch its watchdog on, and short "
            "(`odrv0.axis0.config.watchdog_timeout = 0.05`, `enable_watchdog = True`, a heartbeat "
            "every 100 ms or sooner, save)"
        )

    def _silent_until_off_s(self) -> float:
        """Arm the drive and go silent; return the seconds until it reports that it is off.

        An upper bound of its watchdog's time; infinite where it stayed on.
        """
        self.arm()
        while time.perf_counter() < self._fed_s + _PROOF_S:
            beat = self._heartbeat(time.perf_counter() + 0.002)
            if beat is not None and beat.state != CLOSED_LOOP:
                if beat.error & _WATCHDOG[self.family]:
                    return time.perf_counter() - self._fed_s
                raise DeviceError(
                    f"{self.url}: node {self.node} switched itself off with error "
                    f"0x{beat.error:x}: look it up with odrivetool (`dump_errors(odrv0)`)"
                )
        return math.inf
