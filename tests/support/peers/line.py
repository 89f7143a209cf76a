"""What every simulated peer has: a port that can misbehave, a motion, a clock, a word on stdout."""

import argparse
import contextlib
import heapq
import json
import math
import os
import pty
import random
import signal
import sys
import tempfile
import time
import tty
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import numpy as np
from truth import ObjectMotion, SimulatedHand

from springpot.codegen.files import atomic_write
from springpot.host.simulation.objects import OBJECTS, SimulatedObject


def arguments(description: str) -> argparse.ArgumentParser:
    """Options of all peers. Probabilities are for each frame that the peer sends."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--object", default="ecoflex-00-30", choices=OBJECTS)
    parser.add_argument("--intended-mm", type=float, default=20.0, help="how deep the hand means")
    parser.add_argument("--presses-hz", type=float, default=0.5)
    parser.add_argument("--seed", type=int, default=1)
    for name in ("damage", "drop", "duplicate", "reorder", "late"):
        parser.add_argument(f"--{name}", type=float, default=0.0, metavar="P")
    parser.add_argument("--delay-ms", type=float, default=0.0, help="of every frame, 0 .. twice it")
    parser.add_argument("--gone-after", type=float, metavar="S", help="s after the first force")
    parser.add_argument("--gone-for", type=float, default=1e9, metavar="S")
    parser.add_argument(
        "--lockstep", action="store_true", help="a period passes with each force, not by the clock"
    )
    parser.add_argument("--silent-after", type=float, metavar="S")
    parser.add_argument("--silent-for", type=float, default=1e9, metavar="S")
    parser.add_argument("--thin-after", type=float, metavar="S", help="send each tenth sample")
    parser.add_argument("--burst-after", type=float, metavar="S", help="hold all frames back ...")
    parser.add_argument("--burst-for", type=float, default=0.015, metavar="S", help="... so long")
    return parser


def say(**event: object) -> None:
    """Print one event as JSON, with the time of the system's monotonic clock."""
    print(json.dumps({"at_s": time.monotonic(), **event}), flush=True)


def be_a_device() -> None:
    """Stop on SIGTERM; be scheduled as a device's firmware is, where that is allowed."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(60))


def run(url: str, tick: Callable[[], None]) -> NoReturn:
    """Print the URL, and tick until SIGTERM."""
    be_a_device()
    print(url, flush=True)
    while True:
        tick()


class Noise:
    """Damages, drops, doubles, delays and reorders frames on their way out.

    A late frame goes out together with the next one, before it.
    """

    def __init__(self, options: argparse.Namespace) -> None:
        self._options = options
        self._draw = random.Random(options.seed)
        self._waiting: list[tuple[float, int, bytes]] = []
        self._held: bytes | None = None
        self._late: list[bytes] = []
        self._count = 0

    def out(self, frame: bytes, now_s: float) -> bytes:
        """Bytes to send now, for a frame that the peer sends now."""
        options, chance = self._options, self._draw.random
        frames = [] if chance() < options.drop else [frame]
        if frames and chance() < options.damage:
            content = bytearray(frame)
            content[self._draw.randrange(len(content))] ^= 1 << self._draw.randrange(8)
            frames = [bytes(content)]
        if frames and chance() < options.duplicate:
            frames *= 2
        if self._held is not None:
            frames.append(self._held)
            self._held = None
        elif frames and chance() < options.reorder:
            self._held = frames.pop()
        frames = self._late + frames
        self._late = []
        if frames and chance() < options.late:
            self._late, frames = frames, []
        for content in frames:
            self._count += 1
            due_s = now_s + chance() * 2e-3 * options.delay_ms
            heapq.heappush(self._waiting, (due_s, self._count, content))
        ready = b""
        while self._waiting and self._waiting[0][0] <= now_s:
            ready += heapq.heappop(self._waiting)[2]
        return ready


class Port:
    """A pseudo-terminal under a name that stays: gone and back is a new one under that name."""

    def __init__(self) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="springpot-peer-")
        self.path = Path(self.folder.name) / "port"
        self.master = -1
        self.open()

    def open(self) -> None:
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        with atomic_write(self.path) as new:
            new.symlink_to(os.ttyname(slave))
            os.close(slave)
            os.set_blocking(self.master, False)

    def close(self) -> None:
        self.path.unlink(missing_ok=True)
        os.close(self.master)
        self.master = -1

    def read(self) -> bytes | None:
        """What has come; None while no host has the port open."""
        try:
            return os.read(self.master, 65536)
        except BlockingIOError:
            return b""
        except OSError:
            return None

    def write(self, content: bytes) -> None:
        with contextlib.suppress(OSError):
            os.write(self.master, content)


class Faults:
    """When the peer is gone, silent, or holds frames back; counted from the first force."""

    def __init__(self, options: argparse.Namespace) -> None:
        self._options = options
        self._begin_s: float | None = None
        self._samples = 0

    def no_sample(self) -> bool:
        """Whether this one is not sent."""
        self._samples += 1
        return self.now("silent") or (self.now("thin") and self._samples % 10 != 0)

    @property
    def begun(self) -> bool:
        return self._begin_s is not None

    def force_came(self) -> None:
        if self._begin_s is None:
            self._begin_s = time.monotonic()

    def now(self, kind: str) -> bool:
        after_s = getattr(self._options, f"{kind}_after")
        if after_s is None or self._begin_s is None:
            return False
        since_s = time.monotonic() - self._begin_s - after_s
        return 0 <= since_s < getattr(self._options, f"{kind}_for", math.inf)


class Tool:
    """The device's moving part: held by a hand that presses to and fro, or pressed into an object.

    force_n: of the motor, positive pushes the tool out of the object.
    """

    def __init__(self, options: argparse.Namespace, dt_s: float) -> None:
        self._options, self.dt_s = options, dt_s
        self._hand = SimulatedHand("mid", noisy=True, seed=options.seed)
        self._object = ObjectMotion(SimulatedObject(options.object), dt_s)
        self._ticks = 0
        self._free = np.zeros(1)
        self._speed_mps = 0.0
        self._draw = random.Random(options.seed)

    def in_hand(self, force_n: float) -> tuple[float, float]:
        """One tick in the hand: position and velocity."""
        self._ticks += 1
        turn = 2 * np.pi * self._options.presses_hz * self._ticks * self.dt_s
        intended_m = 0.5e-3 * self._options.intended_mm * (1 - float(np.cos(turn)))
        return self._hand.step(self.dt_s, intended_m, force_n)

    def on_object(self, force_n: float) -> tuple[float, float, float]:
        """One tick on the object: position, velocity, and what the load cell measures."""
        measured_n = float(self._object.move(self._free)[0])
        push_n = -force_n - measured_n - 4.0 * self._speed_mps
        self._speed_mps += self.dt_s * push_n / 0.3
        self._free[0] += self.dt_s * self._speed_mps
        noise = self._draw.gauss
        return self._free[0] + noise(0, 3e-6), self._speed_mps, measured_n + noise(0, 0.015)


class Clock:
    """Absolute deadlines; a peer that was kept away makes up for it."""

    def __init__(self, dt_s: float) -> None:
        self.dt_s = dt_s
        self._next_s = time.monotonic()

    def wait(self) -> None:
        self._next_s += self.dt_s
        left_s = self._next_s - time.monotonic()
        if left_s > 0:
            time.sleep(left_s)
        elif left_s < -0.25:
            self._next_s = time.monotonic()
