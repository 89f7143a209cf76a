"""What the tests on emulated boards share: a target's scenes, motion, skipping without tools."""

import contextlib
import dataclasses
import os
import pty
import re
import subprocess
import threading
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from springpot.codegen.model.model import Model
from springpot.codegen.scene import Scene
from springpot.host.boards.boards import BOARDS, emulator_of, missing
from springpot.host.boards.firmware import build_firmware
from springpot.host.devices.wire import Receiver
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording import Recording
from support.small import DT_S, press, scene, soft_force, training, wandering

TICKS = 10_000


def need(*names: str) -> None:
    """Skip, with what to install, where a board cannot be built or emulated here."""
    for name in names:
        if lacking := missing(BOARDS[name]):
            pytest.skip(lacking)


def target_scene(target: str, **options: str) -> Scene:
    chosen = scene(**options)
    return dataclasses.replace(chosen, runtime=dataclasses.replace(chosen.runtime, target=target))


def long_motion() -> np.ndarray:
    """10 000 ticks: presses of a validation, deeper than trained, then a hand with bad samples."""
    clean = [press(hz, 0.014, cycles=2) for hz in (0.5, 2.0)]
    clean.append(press(1.0, 0.035))
    motion = np.concatenate([*clean, np.full(200, -1e-3), wandering(7, TICKS)])[:TICKS]
    assert len(motion) == TICKS and DT_S == 1e-3
    return motion


def as_firmware_is_scheduled() -> None:
    """Where that is allowed: a board shares its processor with nobody."""
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(50))


@cache
def _firmware(folder: Path, name: str) -> Path:
    out = folder.with_name(f"{folder.name}-firmware-{name}")
    return build_firmware(folder, BOARDS[name], out, strict=True)


@contextmanager
def emulated(folder: Path, name: str) -> Iterator[str]:
    """The firmware of an emitted folder on an emulated board; the path of its serial port."""
    board = BOARDS[name]
    program = _firmware(folder, name)
    command = [
        emulator_of(board), "-M", board.name, *board.options, "-display", "none", "-monitor",
        "none", "-chardev", "pty,id=c0", "-serial", "chardev:c0", "-kernel", str(program),
    ]  # fmt: skip
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               preexec_fn=as_firmware_is_scheduled)  # noqa: PLW1509  # fmt: skip
    try:
        line = process.stdout.readline()
        found = re.search(r"/dev/pts/\d+", line)
        assert found, f"the emulator said: {line}"
        yield found.group(0)
    finally:
        process.terminate()
        process.wait(5)
        process.stdout.close()


SLOW_DT_S = 2e-3


@cache
def slow_model() -> Model:
    """A small forest at 500 Hz."""
    slower = tuple(
        Recording(item.name, item.position_m[::2], item.force_n[::2], SLOW_DT_S)
        for item in training()
    )
    return fit_model("rf-fd", "slow", slower, FitOptions(seed=1, trees=5, leaf=20)).model


def slow_recording(seconds: float, hold: bool = False) -> Recording:
    """Presses at 500 Hz, or one press that stays."""
    one = press(1.0, 0.01)[::2]
    count = round(seconds / SLOW_DT_S)
    position_m = np.tile(one, -(-count // len(one)))[:count]
    if hold:
        position_m = np.concatenate([one[: len(one) // 2], np.full(count, one.max())])
    return Recording("slow", position_m, soft_force(position_m), SLOW_DT_S)


class Relay:
    """Passes bytes between a board and the host's port, and keeps hearing the board afterwards."""

    def __init__(self, board: str) -> None:
        self._board = os.open(board, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        self._master, slave = pty.openpty()
        for port in (self._board, slave):
            tty.setraw(port)
        self.port = os.ttyname(slave)
        os.close(slave)
        os.set_blocking(self._master, False)
        self._receiver, self.calls = Receiver(), []
        self._over = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def send(self, content: bytes) -> None:
        os.write(self._board, content)

    def close(self) -> None:
        self._over = True
        self._thread.join()
        os.close(self._board)
        os.close(self._master)

    def _run(self) -> None:
        while not self._over:
            from_board, from_host = _read(self._board), _read(self._master)
            if from_host:
                self.send(from_host)
            if from_board:
                self.calls += [
                    frame.values
                    for frame in self._receiver.feed(from_board)
                    if frame.name == "rendered"
                ]
                with contextlib.suppress(OSError):
                    os.write(self._master, from_board)
            time.sleep(0.0002)


def _read(port: int) -> bytes:
    try:
        return os.read(port, 4096)
    except OSError:
        return b""
