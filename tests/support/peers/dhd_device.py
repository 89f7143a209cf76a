"""A Force Dimension device behind a stand-in for its SDK: its firmware, which outlives the host.

    python tests/support/peers/dhd_device.py --object ecoflex-00-30

The first line is the URL to use, then one JSON object for each event. Stops on SIGTERM.
"""

import argparse
import os
import random
import re
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from line import Clock, Faults, Port, arguments, be_a_device, say

from springpot.codegen.native.compiler import shared_library
from springpot.host.devices.wire import Receiver, Sender, constant, layout
from springpot.host.simulation.objects import ALL_OBJECTS, HAND_NAMES
from springpot.runtime_c.paths import SIM

SOURCE = Path(__file__).with_name("libdhd.c")
PERIOD_S = 0.0005
ACTING_N = 0.05  # faults begin with the first force that a hand feels
VELOCITY = 2  # the SDK's cause of a trip


def states() -> list[str]:
    """Names of the shared page's doubles, as the library has them."""
    table = re.search(r"enum \{(.*?)STATES", SOURCE.read_text(), re.DOTALL)
    return re.findall(r"^\s+([A-Z_]+),", table.group(1), re.MULTILINE)


class Page:
    """The page that library and firmware share."""

    def __init__(self, file: Path) -> None:
        self._places = {name.lower(): place for place, name in enumerate(states())}
        np.zeros(len(self._places)).tofile(file)
        self._values = np.memmap(file, dtype=np.float64, mode="r+")

    def __getitem__(self, name: str) -> float:
        return float(self._values[self._places[name]])

    def __setitem__(self, name: str, value: float) -> None:
        self._values[self._places[name]] = value


class Firmware:
    """Watchdog, faults and events."""

    def __init__(self, options: argparse.Namespace, page: Page) -> None:
        self.options, self.page = options, page
        self.faults = Faults(options)
        self.enabled = self.gone = self.held = self.tripped_once = False
        self.acting_n = 0.0

    def tick(self) -> None:
        page = self.page
        force_n = max(abs(page[f"force_{axis}"]) for axis in "xyz")
        if force_n > ACTING_N:
            self.faults.force_came()
        for kind, state in (("fail", "fails"), ("silent", "stale"),
                            ("refuse", "refuses"), ("button", "button")):  # fmt: skip
            page[state] = self.faults.now(kind)
        if self.faults.now("burst") and not self.held:  # one call takes as long
            self.held = True
            page["hangs_s"] = self.options.burst_for
        gone = self.faults.now("gone")
        if gone != self.gone:
            say(event="gone" if gone else "back", was_n=force_n)
            self.gone = gone
            page["connected"] = not gone
            if gone:
                self.off("usb", 5, force_n)
        if self.faults.now("trip") and not self.tripped_once:
            self.tripped_once = True
            self.off("fault", VELOCITY, force_n)
        self.tell(force_n)  # before the watchdog: a peer that was held up still saw the start
        self.watch(force_n)
        self.tell(force_n)

    def watch(self, force_n: float) -> None:
        page = self.page
        silent_s = time.monotonic() - page["force_s"]
        if page["enabled"] and page["watchdog_s"] and silent_s > page["watchdog_s"]:
            acted = self.faults.begun
            self.off("tripped" if acted else "proved", 3, force_n, silent_ms=1e3 * silent_s)

    def off(self, event: str, cause: int, was_n: float, **more: float) -> None:
        """Ends the force. Events go out first: a host that sees it off may switch it on at once."""
        page = self.page
        for axis in "xyz":
            page[f"force_{axis}"] = 0
        say(event=event, was_n=was_n, **more)
        if self.enabled:
            self.say_stop()
        page["cause"], page["enabled"] = cause, 0

    def tell(self, force_n: float) -> None:
        if self.page["enabled"] and not self.enabled:
            say(event="start")
            self.enabled = True
        elif self.enabled and not self.page["enabled"]:
            self.say_stop()
        if self.acting_n > ACTING_N and force_n == 0:
            say(event="zero", was_n=self.acting_n)
        self.acting_n = force_n

    def say_stop(self) -> None:
        self.enabled = False
        say(event="stop", force_n=max(abs(self.page[f"force_{axis}"]) for axis in "xyz"),
            max_force_n=self.page["max_force_n"], mass_kg=self.page["mass_kg"],
            watchdog_s=self.page["watchdog_s"],
            place_m=[self.page[f"place_{axis}"] for axis in "xyz"])  # fmt: skip


class LoadCell:
    """A force sensor on a serial line of its own: it sends late what is between tool and object."""

    def __init__(self, late_s: float, page: Page) -> None:
        self.port, self._page = Port(), page
        self._late_s, self._draw = late_s, random.Random(1)
        self._sender, self._receiver = Sender(), Receiver()
        self._felt: list[tuple[float, float]] = []
        self._next_s = 0.0

    def tick(self) -> None:
        now_s = time.monotonic()
        self._felt.append((now_s, self._page["object_n"]))
        for frame in self._receiver.feed(self.port.read() or b""):
            if frame.name == "ask":
                self._receiver.restart()
                self._send("hello", layout=layout(), rate_hz=1000.0, max_n=0.0)
            elif frame.name == "command":
                self._send("ack", command=frame.sequence, refused=0)
                started = frame.values["action"] == constant("START")
                self._next_s = now_s if started else 0.0
        while self._next_s and self._next_s <= now_s:
            measured_n = self._felt_n(self._next_s) + self._draw.gauss(0, 0.01)
            self._send("sample", status=constant("LOAD_CELL"), position_m=0.0, velocity_mps=0.0,
                       measured_n=measured_n)  # fmt: skip
            self._next_s += 1e-3

    def _felt_n(self, at_s: float) -> float:
        while len(self._felt) > 2 and self._felt[1][0] < at_s - self._late_s:
            self._felt.pop(0)
        times_s, forces_n = zip(*self._felt, strict=True)
        return float(np.interp(at_s - self._late_s, times_s, forces_n))

    def _send(self, name: str, **values: Any) -> None:
        self.port.write(self._sender.encode(name, **values))


def main() -> None:
    parser = arguments(__doc__.splitlines()[0])
    for kind in ("fail", "refuse", "button", "trip"):
        parser.add_argument(f"--{kind}-after", type=float, metavar="S")
        parser.add_argument(f"--{kind}-for", type=float, default=1e9, metavar="S")
    parser.add_argument("--cell-ms", type=float, help="a load cell on a serial line, so late")
    parser.add_argument("--pressing", action="store_true", help="on the object, nobody holds it")
    parser.add_argument("--surface-mm", type=float, default=0.0, help="height of the surface")
    parser.add_argument("--sideways-n", type=float, default=0.0, help="pushes across the axis")
    parser.add_argument("--saturated-n", type=float, default=0.0, help="most that its motors give")
    for flag in ("no-watchdog", "uncalibrated", "unpowered", "in-use", "absent"):
        parser.add_argument(f"--{flag}", action="store_true")
    options = parser.parse_args()
    built = shared_library([SOURCE, *sorted(SIM.glob("*.c"))], [SIM], ["-ldl"])
    with tempfile.TemporaryDirectory(prefix="springpot-peer-") as folder:
        library = Path(folder) / "libdhd.so"
        shutil.copy(built, library)
        page = Page(library.with_name("libdhd.so.state"))
        set_up(page, options)
        cell = None if options.cell_ms is None else LoadCell(1e-3 * options.cell_ms, page)
        firmware, clock = Firmware(options, page), Clock(PERIOD_S)
        be_a_device()
        print(f"dhd://?library={library}&surface_mm={-options.surface_mm:g}", flush=True)
        if cell is not None:
            say(event="cell", url=f"serial://{cell.port.path}?baud=4000000")
        parent = os.getppid()
        while os.getppid() == parent:
            clock.wait()
            firmware.tick()
            if cell is not None:
                cell.tick()


def set_up(page: Page, options: argparse.Namespace) -> None:
    page["connected"], page["powered"] = not options.absent, not options.unpowered
    page["calibrated"], page["in_use"] = not options.uncalibrated, options.in_use
    page["has_watchdog"], page["presses"] = not options.no_watchdog, options.pressing
    page["object"] = ALL_OBJECTS.index(options.object)
    page["hand"] = HAND_NAMES.index("mid")
    page["presses_hz"], page["intended_m"] = options.presses_hz, 1e-3 * options.intended_mm
    page["seed"], page["surface_m"] = options.seed, 1e-3 * options.surface_mm
    page["sideways_n"], page["saturated_n"] = options.sideways_n, options.saturated_n


if __name__ == "__main__":
    main()
