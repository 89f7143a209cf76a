"""An ODrive on python-can's udp_multicast bus, within this machine (hop limit 0).

    python tests/support/peers/udp_odrive.py --object ecoflex-00-30

The first line is the URL to use, then one JSON object for each event. Stops on SIGTERM.
"""

import argparse
import struct
import time

import can
from axis import Axis, add_options
from line import Noise, arguments, run

GROUP = "239.74.163.2"
FRAME = struct.Struct("<H8s")


class Bus:
    """The axis on a multicast group."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.noise, self.axis = Noise(options), Axis(options)
        self.bus = can.Bus(interface="udp_multicast", channel=GROUP, port=options.port, hop_limit=0)

    def send(self, identifier: int, data: bytes) -> None:
        faults = self.axis.faults
        if faults.now("gone") or faults.now("burst"):
            return
        content = self.noise.out(FRAME.pack(identifier, data), time.monotonic())
        for number, part in FRAME.iter_unpack(content):
            self.bus.send(can.Message(arbitration_id=number, data=part, is_extended_id=False))

    def tick(self) -> None:
        self.axis.clock.wait()
        while (message := self.bus.recv(0)) is not None:
            taken = self.axis.take(message.arbitration_id, bytes(message.data),
                                   message.is_remote_frame)  # fmt: skip
            for frame in taken:
                self.send(*frame)
        for frame in self.axis.step():
            self.send(*frame)


def main() -> None:
    parser = arguments(__doc__.splitlines()[0])
    add_options(parser)
    parser.add_argument("--port", type=int, default=43113)
    options = parser.parse_args()
    bus = Bus(options)
    url = f"odrive://udp_multicast/{GROUP}?port={options.port}&{bus.axis.settings}"
    run(url, bus.tick)


if __name__ == "__main__":
    main()
