"""Recordings replayed through a board that renders: one sample at a time, every force compared."""

import contextlib
import time
from collections.abc import Iterator

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.plan.plan import Plan
from springpot.host.devices.device import requirements_of
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.serial_device import SerialDevice
from springpot.host.native.replay import Replay

_ANSWER_S = 5.0
_POLL_S = 0.0001
_TRIES = 5
_Answer = tuple[float, int]


class BoardReplay:
    """A board that is fed a recording: it answers each sample with what its scene returned.

    The recording's own time counts on the board, not the host's: a host that is slow, or stands
    still, changes no force. The motor gets none.
    """

    def __init__(self, device: SerialDevice) -> None:
        self._device = device

    def run(self, position_m: Reals, velocity_mps: Reals) -> tuple[Reals, Reals]:
        """Forces (N, single precision) and notes of each sample from a reset; shapes (n,).

        A replay that missed a frame begins again. Raises DeviceError where a sample is not
        answered, or each try missed one.
        """
        for _ in range(_TRIES):
            answers = self._replayed(position_m, velocity_mps)
            if answers is not None:
                force_n, notes = zip(*answers, strict=True)
                return np.array(force_n, dtype=np.float32), np.array(notes, dtype=np.int32)
        raise DeviceError(
            f"{self._device.address.url}: a frame was lost in each of {_TRIES} tries "
            f"({self._lost()} so far): check the cable and ?baud="
        )

    def compared(self, replay: Replay, position_m: Reals, velocity_mps: Reals) -> tuple[Reals, int]:
        """Forces of the board, N, and the samples where this machine's C differs in a bit."""
        # The line carries single precision.
        sent = [values.astype(np.float32) for values in (position_m, velocity_mps)]
        board_n, board_notes = self.run(*sent)
        here_n, here_notes = replay.run(*sent)
        other = here_n.astype(np.float32).view(np.uint32) != board_n.view(np.uint32)
        return board_n, int(np.sum(other | (board_notes != here_notes)))

    def _replayed(self, position_m: Reals, velocity_mps: Reals) -> list[_Answer] | None:
        self._device.command("REPLAY")
        lost, answers = self._lost(), list[_Answer]()
        for i, (position, velocity) in enumerate(
            zip(position_m.tolist(), velocity_mps.tolist(), strict=True)
        ):
            self._device.send("feed", position_m=position, velocity_mps=velocity)
            answer = self._answer(i, lost)
            if self._lost() != lost:  # what the board did then is not known
                return None
            answers += answer
        return answers

    def _lost(self) -> int:
        return self._device.receiver.crc_errors + self._device.receiver.gaps

    def _answer(self, sample: int, lost: int) -> list[_Answer]:
        until = time.monotonic() + _ANSWER_S
        while time.monotonic() < until:
            answer = [(frame.values["force_n"], frame.values["notes"])
                      for frame in self._device.frames()
                      if frame.name == "rendered" and not frame.old]  # fmt: skip
            if answer or self._lost() != lost:
                return answer
            time.sleep(_POLL_S)
        receiver = self._device.receiver
        raise DeviceError(
            f"{self._device.address.url}: sample {sample} was not answered in {_ANSWER_S:g} s "
            f"({receiver.crc_errors} damaged frames, {receiver.gaps} missing): check the cable and "
            "?baud="
        )


@contextlib.contextmanager
def board_replay(url: str, plan: Plan, scene_hash: str) -> Iterator[BoardReplay]:
    """Open a board for replays; it is stopped at the end. Raises UsageError for another device."""
    address = parse_device(url)
    if address.scheme != "serial":
        raise UsageError(f"{url}: only a board that renders can replay: give serial://PORT")
    requirements = requirements_of(
        plan.scene.device,
        rate_hz=1 / plan.dt_s,
        watchdog_s=plan.watchdog_s,
        max_n=0.0,
        hash=scene_hash,
    )
    device = SerialDevice(address, requirements)
    try:
        if not device.renders:
            raise UsageError(
                f"{url}: a simple device renders nothing by itself: `springpot run` drives it, "
                "`springpot validate` takes the log"
            )
        yield BoardReplay(device)
    finally:
        device.stop()
        device.close()
