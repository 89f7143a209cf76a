"""One axis of an ODrive behind CAN Simple frames: what the two CAN peers have in common."""

import argparse
import math
import struct
import time

from line import Clock, Faults, Tool, say

HEARTBEAT_S = 0.1
IDLE, CLOSED_LOOP = 1, 8
WATCHDOG = {"0.5": 0x800, "0.6": 0x1000000}
Frame = tuple[int, bytes]


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--node", type=int, default=0)
    parser.add_argument("--firmware", choices=("0.5", "0.6"), default="0.6")
    parser.add_argument("--rate-hz", type=float, default=1000.0, help="of encoder estimates")
    parser.add_argument("--m-per-turn", type=float, default=0.1)
    parser.add_argument("--max-torque-nm", type=float, default=1.0)
    parser.add_argument("--sign", type=int, choices=(1, -1), default=1)
    parser.add_argument("--no-watchdog", action="store_true")
    parser.add_argument("--watchdog-ms", type=float, default=30.0)
    parser.add_argument("--on-object", action="store_true", help="an object instead of a hand")


class Axis:
    """Frames in, frames out; the motor moves a tool in a simulated hand."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.faults = Faults(options)
        self.clock = Clock(1 / options.rate_hz)
        self.forget()

    def forget(self) -> None:
        """Power on."""
        self.tool = Tool(self.options, 1 / self.options.rate_hz)
        self.state, self.error, self.torque_nm = IDLE, 0, 0.0
        self.fed_s = self.beat_s = time.monotonic()

    @property
    def settings(self) -> str:
        """What the URL has to say about the transmission."""
        o = self.options
        return (f"node={o.node}&m_per_turn={o.m_per_turn}&max_torque_nm={o.max_torque_nm}"
                f"&sign={o.sign}")  # fmt: skip

    def take(self, identifier: int, data: bytes, remote: bool = False) -> list[Frame]:
        """Obey one frame; what the drive answers."""
        command = identifier & 31
        asked = command in (0x07, 0x0B, 0x0E, 0x18) or (command == 0 and remote)
        if identifier >> 5 != self.options.node or not asked:
            return []  # on a multicast bus its own frames come back
        self.fed_s = time.monotonic()
        match command:
            case 0x00 if remote and self.options.firmware == "0.6":
                return [self._frame(0x00, bytes([2, 4, 4, 58, 0, 6, 10, 0]))]
            case 0x07:
                requirements = struct.unpack_from("<I", data)[0]
                if requirements == CLOSED_LOOP and not self.error:
                    self.state, self.tool = CLOSED_LOOP, Tool(self.options, self.tool.dt_s)
                elif requirements == IDLE:
                    self.state, self.torque_nm = IDLE, 0.0
                say(event="state", state=self.state)
                return [self._heartbeat()]
            case 0x0E if self.state == CLOSED_LOOP:
                torque_nm = struct.unpack_from("<f", data)[0]
                if abs(self.torque_nm) > 1e-3 and not torque_nm:
                    say(event="zero", was_nm=self.torque_nm)
                self.torque_nm = torque_nm
                if torque_nm:
                    self.faults.force_came()
            case 0x18:
                self.error = 0
        return []

    def step(self) -> list[Frame]:
        """One period: watchdog, motion, what the drive sends by itself."""
        now_s, frames = time.monotonic(), []
        silent_s = now_s - self.fed_s
        if (self.state == CLOSED_LOOP and not self.options.no_watchdog
                and silent_s > 1e-3 * self.options.watchdog_ms):  # fmt: skip
            say(event="tripped", silent_ms=1e3 * silent_s, was_nm=self.torque_nm)
            self.state, self.torque_nm = IDLE, 0.0
            self.error |= WATCHDOG[self.options.firmware]
            frames.append(self._heartbeat())
        turn_n = -self.options.sign * 2 * math.pi / self.options.m_per_turn
        force_n = self.torque_nm * turn_n
        if self.options.on_object:
            position_m, velocity_mps, _ = self.tool.on_object(force_n)
        else:
            position_m, velocity_mps = self.tool.in_hand(force_n)
        scale = self.options.sign / self.options.m_per_turn
        if not self.faults.no_sample():
            estimates = struct.pack("<ff", scale * position_m, scale * velocity_mps)
            frames.append(self._frame(0x09, estimates))
            if self.options.firmware == "0.6" and self.options.on_object:
                torques = struct.pack("<ff", self.torque_nm, self.torque_nm)
                frames.append(self._frame(0x1C, torques))
        if now_s - self.beat_s > HEARTBEAT_S:
            self.beat_s = now_s
            frames.append(self._heartbeat())
        return frames

    def _heartbeat(self) -> Frame:
        # 0.5: error flags and "trajectory done"; 0.6: procedure result, trajectory done
        tail = bytes([0, 0, 0x80]) if self.options.firmware == "0.5" else bytes([0, 1, 0])
        return self._frame(0x01, struct.pack("<IB", self.error, self.state) + tail)

    def _frame(self, command: int, data: bytes) -> Frame:
        return self.options.node << 5 | command, data
