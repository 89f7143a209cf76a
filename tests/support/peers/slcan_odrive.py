"""A Lawicel (slcan) adapter on a pseudo-terminal, with an ODrive on its bus.

    python tests/support/peers/slcan_odrive.py --object ecoflex-00-30

The first line is the URL to use, then one JSON object for each event. Stops on SIGTERM.
"""

import argparse
import time

from axis import Axis, add_options
from line import Noise, Port, arguments, run, say


class Adapter:
    """Text in, text out."""

    def __init__(self, options: argparse.Namespace, port: Port) -> None:
        self.port, self.noise, self.axis = port, Noise(options), Axis(options)
        self.pending, self.held = b"", b""
        self.open = False

    def command(self, line: bytes) -> None:
        """One line of the host; a bell where it is none."""
        kind, answer = line[:1], b"\r"
        try:
            if kind == b"O":
                self.open = True
            elif kind == b"C":
                self.open = False
            elif kind in b"tr" and line and self.open:
                size = int(line[4:5], 16)
                data = bytes.fromhex(line[5:].decode()) if kind == b"t" else b""
                if kind == b"t" and len(data) != size:
                    raise ValueError
                answer = b"z\r"
                for frame in self.axis.take(int(line[1:4], 16), data, kind == b"r"):
                    self.frame(*frame)
            elif line and kind != b"S":
                raise ValueError
        except ValueError:
            answer = b"\a"
        self.held += answer

    def frame(self, identifier: int, data: bytes) -> None:
        text = f"t{identifier:03X}{len(data)}{data.hex().upper()}\r".encode()
        self.held += self.noise.out(text, time.monotonic()) if self.open else b""

    def tick(self) -> None:
        faults = self.axis.faults
        self.axis.clock.wait()
        if self.port.master < 0:
            if not faults.now("gone"):
                self.port.open()
                say(event="back")
            return
        if faults.now("gone"):
            say(event="gone", was_nm=self.axis.torque_nm)
            self.port.close()
            self.axis.forget()
            self.open, self.pending, self.held = False, b"", b""
            return
        content = self.port.read()
        if content:
            *lines, self.pending = (self.pending + content).split(b"\r")
            for line in lines:
                self.command(line)
        for frame in self.axis.step():
            self.frame(*frame)
        if content is None:
            self.held = b""
        if self.held and not faults.now("burst"):
            self.port.write(self.held)
            self.held = b""


def main() -> None:
    parser = arguments(__doc__.splitlines()[0])
    add_options(parser)
    options = parser.parse_args()
    port = Port()
    adapter = Adapter(options, port)
    run(f"odrive://slcan/{port.path}?{adapter.axis.settings}", adapter.tick)


if __name__ == "__main__":
    main()
