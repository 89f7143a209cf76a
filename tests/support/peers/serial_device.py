"""A simple springpot serial device on a pseudo-terminal: position in a hand, or an object to press.

    python tests/support/peers/serial_device.py --object ecoflex-00-30

The first line is the URL to use, then one JSON object for each event. Stops on SIGTERM.
"""

import argparse
import time
from typing import Any

from line import Clock, Faults, Noise, Port, Tool, arguments, run, say

from springpot.host.devices.wire import Receiver, Sender, constant, layout

START, STOP, RESET, PRESS = (constant(name) for name in ("START", "STOP", "RESET", "PRESS"))
IDLE_RATE_HZ = 1000.0


class Board:
    """The firmware: commands, watchdog, samples."""

    def __init__(self, options: argparse.Namespace, port: Port) -> None:
        self.options, self.port = options, port
        self.noise, self.faults = Noise(options), Faults(options)
        self.forget()
        self.rate_hz = IDLE_RATE_HZ
        self.clock = Clock(1 / self.rate_hz)

    def forget(self) -> None:
        """Power on."""
        self.sender, self.receiver = Sender(), Receiver()
        self.force_n = 0.0
        self.running = self.tripped = self.pressing = False
        self.watchdog_s = 0.02
        self.force_came_s: float | None = None
        self.forces = 0  # since START; the first only proves the watchdog
        self.tool: Tool | None = None
        self.held = b""

    def send(self, name: str, **values: Any) -> None:
        frame = self.noise.out(self.sender.encode(name, **values), time.monotonic())
        self.held += frame
        if self.faults.now("burst"):
            return
        if self.held:
            self.port.write(self.held)
            self.held = b""

    def hello(self) -> None:
        self.send("hello", layout=layout(), rate_hz=self.rate_hz, max_n=20.0)

    def command(self, sequence: int, action: int, watchdog_s: float, rate_hz: float) -> None:
        refused = 0
        if not 10 <= rate_hz <= 8000:
            refused = constant("REFUSED_RATE")
        elif action in (START, PRESS):
            self.rate_hz, self.watchdog_s = rate_hz, watchdog_s
            self.tool = Tool(self.options, 1 / rate_hz)
            self.clock = Clock(1 / rate_hz)
            self.running, self.pressing, self.tripped = True, action == PRESS, False
            self.force_came_s, self.force_n, self.forces = None, 0.0, 0
            say(event="start", rate_hz=rate_hz, watchdog_ms=1e3 * watchdog_s)
        elif action == STOP:
            say(event="stop", force_n=self.force_n)
            self.running, self.force_n = False, 0.0
        elif action == RESET:
            self.tripped, self.force_came_s = False, None
            if self.forces > 1:
                say(event="reset")
        self.send("ack", command=sequence, refused=refused)

    def take(self, content: bytes) -> None:
        for frame in self.receiver.feed(content):
            values = frame.values
            if frame.name == "force" and not frame.old and self.running and not self.tripped:
                if abs(self.force_n) > 0.05 and not values["force_n"]:
                    say(event="zero", was_n=self.force_n)
                self.force_n, self.force_came_s = values["force_n"], time.monotonic()
                self.forces += 1
                if self.forces > 1:
                    self.faults.force_came()
                if self.options.lockstep:
                    self.sample()
            elif frame.name == "ask":
                self.receiver.restart()
                self.hello()
            elif frame.name == "command":
                self.command(frame.sequence, **values)

    def watch(self) -> None:
        """The device's own watchdog: latched until a command. In lockstep no time passes once
        forces come."""
        if self.faults.now("trip") and not self.tripped:
            say(event="fault", was_n=self.force_n)
            self.force_n, self.tripped = 0.0, True
        if self.options.lockstep and self.forces > 1:
            return
        if self.running and not self.tripped and self.force_came_s is not None:
            silent_s = time.monotonic() - self.force_came_s
            if silent_s > self.watchdog_s:
                name = "tripped" if self.forces > 1 else "proved"
                say(event=name, silent_ms=1e3 * silent_s, was_n=self.force_n)
                self.force_n, self.tripped = 0.0, True

    def sample(self) -> None:
        if not self.running or self.tool is None:
            return
        measured_n, cell = 0.0, 0
        if self.pressing:
            position_m, velocity_mps, measured_n = self.tool.on_object(self.force_n)
            cell = constant("LOAD_CELL")
        else:
            position_m, velocity_mps = self.tool.in_hand(self.force_n)
        status = constant("RUNNING") | cell | (constant("TRIPPED") if self.tripped else 0)
        if not self.faults.no_sample():
            self.send("sample", status=status, position_m=position_m, velocity_mps=velocity_mps,
                      measured_n=measured_n)  # fmt: skip

    def tick(self) -> None:
        self.clock.wait()
        if self.port.master < 0:
            if not self.faults.now("gone"):
                self.port.open()
                say(event="back")
            return
        if self.faults.now("gone"):
            say(event="gone", was_n=self.force_n)
            self.port.close()
            self.forget()
            return
        content = self.port.read()
        if content:
            self.take(content)
        self.watch()
        if content is not None and (
            self.tripped or not (self.options.lockstep and self.force_came_s)
        ):
            self.sample()


def main() -> None:
    parser = arguments(__doc__.splitlines()[0])
    parser.add_argument("--trip-after", type=float, metavar="S", help="a fault of its own, 10 ms")
    options = parser.parse_args()
    options.trip_for = 0.01
    port = Port()
    board = Board(options, port)
    run(f"serial://{port.path}?baud=4000000", board.tick)


if __name__ == "__main__":
    main()
