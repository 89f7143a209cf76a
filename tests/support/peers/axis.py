"""One axis of an ODrive behind CAN Simple frames: what the two CAN peers have in common."""

import argparse
import math
import struct
import time

from line import Clock, Faults, Tool, say

HEARTBEAT_S = 0.1
IDLE, CLOSED_LOOP = 1, 8
# Errors: the watchdog's; too fast (0.5: the controller failed, with a flag of its own).
WATCHDOG = {"0.5": 0x800, "0.6": 0x1000000}
OVERSPEED = {"0.5": 0x200, "0.6": 0x8000}
STEP_HZ = 1000.0  # its motion and its watchdog, whatever it sends
# Of a drive whose limits nobody has set.
TURNS_PER_S, TOLERANCE, CURRENT_A = 2.0, 1.2, 10.0
GAIN_NM_S = 1 / 6  # vel_gain
M_PER_TURN, NM_PER_A, WATCHDOG_S = 0.1, 0.1, 0.03
Frame = tuple[int, bytes]


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--node", type=int, default=0)
    parser.add_argument("--firmware", choices=("0.5", "0.6"), default="0.6")
    parser.add_argument("--rate-hz", type=float, default=100.0, help="of encoder estimates")
    parser.add_argument("--sign", type=int, choices=(1, -1), default=1)
    parser.add_argument("--on-object", action="store_true", help="an object instead of a hand")


class Axis:
    """Frames in, frames out; the motor moves a tool in a simulated hand."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.faults = Faults(options)
        self.clock = Clock(1 / max(STEP_HZ, options.rate_hz))
        self.steps_a_sample = max(1, round(STEP_HZ / options.rate_hz))
        self.forget()

    def forget(self) -> None:
        """Power on."""
        self.tool = Tool(self.options, self.clock.dt_s)
        self.state, self.error, self.torque_nm, self.turns_per_s = IDLE, 0, 0.0, 0.0
        self.max_turns_per_s, self.max_current_a = TURNS_PER_S, CURRENT_A
        self.steps = 0
        self.fed_s = self.beat_s = time.monotonic()

    @property
    def settings(self) -> str:
        """What the URL has to say about the transmission."""
        o = self.options
        return (f"node={o.node}&m_per_turn={M_PER_TURN}&max_torque_nm=1.0&nm_per_a={NM_PER_A}"
                f"&sign={o.sign}")  # fmt: skip

    def take(self, identifier: int, data: bytes, remote: bool = False) -> list[Frame]:
        """Obey one frame; what the drive answers."""
        command = identifier & 31
        asked = command in (0x07, 0x0B, 0x0E, 0x0F, 0x18) or (command == 0 and remote)
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
            case 0x0E if self.state == CLOSED_LOOP:
                torque_nm = struct.unpack_from("<f", data)[0]
                if abs(self.torque_nm) > 1e-3 and not torque_nm:
                    say(event="zero", was_nm=self.torque_nm)
                self.torque_nm = torque_nm
                if torque_nm:
                    self.faults.force_came()
            case 0x0F:
                self.max_turns_per_s, self.max_current_a = struct.unpack("<ff", data)
            case 0x18:
                self.error = 0
        return []

    def step(self) -> list[Frame]:
        """One period: watchdog, motion, what the drive sends by itself."""
        now_s, frames = time.monotonic(), []
        silent_s = now_s - self.fed_s
        if silent_s > WATCHDOG_S:
            self.error |= WATCHDOG[self.options.firmware]  # in every state
            if self.state == CLOSED_LOOP:
                say(event="tripped", silent_ms=1e3 * silent_s, was_nm=self.torque_nm)
                self.state, self.torque_nm = IDLE, 0.0
        if (self.state == CLOSED_LOOP
                and abs(self.turns_per_s) > TOLERANCE * self.max_turns_per_s):  # fmt: skip
            say(event="overspeed", turns_per_s=self.turns_per_s, was_nm=self.torque_nm)
            self.state, self.torque_nm = IDLE, 0.0
            self.error |= OVERSPEED[self.options.firmware]
        torque_nm = self.given_nm()
        turn_n = -self.options.sign * 2 * math.pi / M_PER_TURN
        force_n = torque_nm * turn_n
        if self.options.on_object:
            position_m, velocity_mps, _ = self.tool.on_object(force_n)
        else:
            position_m, velocity_mps = self.tool.in_hand(force_n)
        scale = self.options.sign / M_PER_TURN
        self.turns_per_s = scale * velocity_mps
        self.steps += 1
        if self.steps % self.steps_a_sample == 0 and not self.faults.no_sample():
            estimates = struct.pack("<ff", scale * position_m, scale * velocity_mps)
            frames.append(self._frame(0x09, estimates))
            if self.options.firmware == "0.6" and self.options.on_object:
                torques = struct.pack("<ff", self.torque_nm, torque_nm)
                frames.append(self._frame(0x1C, torques))
        if now_s - self.beat_s > HEARTBEAT_S:
            self.beat_s = now_s
            frames.append(self._heartbeat())
        return frames

    def given_nm(self) -> float:
        """What the motor gives of the torque that it was told: limited by speed, and by current."""
        gain, limit = GAIN_NM_S, self.max_turns_per_s
        given = min(max(self.torque_nm, gain * (-limit - self.turns_per_s)),
                    gain * (limit - self.turns_per_s))  # fmt: skip
        most_nm = self.max_current_a * NM_PER_A
        return min(max(given, -most_nm), most_nm) if self.state == CLOSED_LOOP else 0.0

    def _heartbeat(self) -> Frame:
        # 0.5: error flags, the controller's with "trajectory done"; 0.6: procedure result, done
        failed = int(self.error == OVERSPEED["0.5"])
        tail = bytes([0, 0, 0x80 | failed]) if self.options.firmware == "0.5" else bytes([0, 1, 0])
        return self._frame(0x01, struct.pack("<IB", self.error, self.state) + tail)

    def _frame(self, command: int, data: bytes) -> Frame:
        return self.options.node << 5 | command, data
