"""A board that renders an emitted scene by itself, on a pseudo-terminal; fed, or in a hand.

    python tests/support/peers/serial_board.py --scene FOLDER [--fed]

The first line is the URL to use, then one JSON object for each event. Stops on SIGTERM.
"""

import argparse
from pathlib import Path
from typing import Any

from line import Port, arguments, be_a_device
from serial_device import PRESS, RESET, START, Board

from springpot.host.devices.wire import constant
from springpot.host.native.scene_library import SceneLibrary


class RenderingBoard(Board):
    """Firmware with the scene in it: a call every period, told to whoever listens."""

    role = "RENDERS"

    def __init__(self, options: argparse.Namespace, port: Port, scene: SceneLibrary) -> None:
        self.state, self.model = scene.new_state(), bytes.fromhex(scene.manifest["hash"])
        self.fed: dict[str, float] | None = None
        self.was_reset = False
        self.last = (0.0, 0.0)
        super().__init__(options, port)

    def command(self, sequence: int, action: int, watchdog_s: float, rate_hz: float) -> None:
        super().command(sequence, action, watchdog_s, rate_hz)
        if action in (START, RESET, PRESS):
            self.state.reset()
            self.was_reset = True

    def take(self, content: bytes) -> None:
        for frame in self.receiver.feed(content):
            if frame.name == "ask":
                self.receiver.restart()
                self.hello()
            elif frame.name == "command":
                self.command(frame.sequence, **frame.values)
            elif frame.name == "feed" and not frame.old:
                self.fed = frame.values
                self.faults.force_came()

    def watch(self) -> None:
        """The scene's own watchdog does it."""

    def sample(self) -> None:
        if not self.running or self.tool is None:
            return
        dt_s, call = self.tool.dt_s, constant("WAS_RESET") * self.was_reset
        if self.options.fed:
            motion: Any = self.fed and tuple(self.fed.values())
            self.fed = None
        else:
            motion = self.tool.in_hand(self.force_n)
        if motion:
            self.last = motion
            self.force_n, notes = self.state.step(*motion)
        else:
            call |= constant("IDLE")
            self.force_n, notes = self.state.idle(dt_s)
        self.was_reset = False
        self.send("rendered", call=call, position_m=self.last[0], velocity_mps=self.last[1],
                  dt_s=dt_s, force_n=self.force_n, notes=notes)  # fmt: skip


def main() -> None:
    parser = arguments(__doc__.splitlines()[0])
    parser.add_argument("--scene", type=Path, required=True, help="folder of springpot emit")
    parser.add_argument("--fed", action="store_true", help="take motion from the host only")
    options = parser.parse_args()
    scene = SceneLibrary(options.scene)
    port = Port()
    board = RenderingBoard(options, port, scene)
    be_a_device()
    print(f"serial://{port.path}?baud=4000000", flush=True)
    while True:
        board.tick()


if __name__ == "__main__":
    main()
