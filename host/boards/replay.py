"""Recordings replayed through a board that renders: one sample at a time, every force compared."""

import contextlib
import time
from collections.abc import Iterator

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.notes import LATCHED
from springpot.host.devices.device import requirements_of
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.lines.wire import Frame, constant
from springpot.host.devices.serial_device import SerialDevice
from springpot.host.native.loop_library import IDLE, INPUT, RESET
from springpot.host.native.replay import Replay

_ANSWER_S = 1.0
_POLL_S = 0.0001
_TRIES = 5
_NAMES = ("call", INPUT, "velocity_mps", "dt_s", "returned_n", "notes")
_Row = tuple[float, ...]


class BoardReplay:
    """A board that is fed: it answers each sample with what its scene returned."""

    def __init__(self, device: SerialDevice) -> None:
        self._device = device
        self._unread: Iterator[Frame] = iter(())

    def run(self, position_m: Reals, velocity_mps: Reals) -> dict[str, Reals]:
        """Replay from a reset; the calls that the board made, as channels of a session's log.

        Calls of sp_idle in between belong to them. A host that was kept away until the board's
        watchdog latched, or that missed a frame, begins again. Raises DeviceError where a sample
        is not answered.
        """
        for _ in range(_TRIES):
            rows = self._replayed(position_m, velocity_mps)
            if rows is not None:
                return dict(zip(_NAMES, np.array(rows).T, strict=True))
        raise DeviceError(
            f"{self._device.address.url}: in each of {_TRIES} tries the board's watchdog latched "
            f"or a frame was lost ({self._lost()} so far): end other programs, raise "
            "guard.watchdog_ms, check the cable"
        )

    def compared(self, replay: Replay, position_m: Reals, velocity_mps: Reals) -> tuple[Reals, int]:
        """Replay from a reset; as `board_force`."""
        return board_force(replay, self.run(position_m, velocity_mps))

    def _replayed(self, position_m: Reals, velocity_mps: Reals) -> list[_Row] | None:
        self._device.command("RESET")
        self._unread = iter(())
        lost, rows = self._lost(), list[_Row]()
        for i, (position, velocity) in enumerate(
            zip(position_m.tolist(), velocity_mps.tolist(), strict=True)
        ):
            self._device.send("feed", position_m=position, velocity_mps=velocity)
            answer = self._answer(i)
            if any(int(row[0]) & IDLE and int(row[-1]) & LATCHED for row in answer):
                return None
            rows += answer
        if self._lost() != lost:  # of the board's own calls too: what it did then is not known
            return None
        rows[0] = (rows[0][0] + (0 if int(rows[0][0]) & RESET else RESET), *rows[0][1:])
        return rows

    def _lost(self) -> int:
        return self._device.receiver.crc_errors + self._device.receiver.gaps

    def _answer(self, sample: int) -> list[_Row]:
        """Calls up to the one that took the sample; what came behind it is kept for the next."""
        until = time.monotonic() + _ANSWER_S
        rows: list[_Row] = []
        while time.monotonic() < until:
            for frame in self._unread:
                if frame.name != "rendered" or frame.old:
                    continue
                values = frame.values
                idle = bool(values["call"] & constant("IDLE"))
                was_reset = bool(values["call"] & constant("WAS_RESET"))
                call = IDLE * idle + RESET * was_reset
                rows.append((call, values["position_m"], values["velocity_mps"], values["dt_s"],
                             values["force_n"], values["notes"]))  # fmt: skip
                if not idle:
                    return rows
            self._unread = iter(self._device.frames())
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


def board_force(replay: Replay, calls: dict[str, Reals]) -> tuple[Reals, int]:
    """Force of each sample on the board, N, and the calls where this machine's C differs in a bit.

    The board reports forces in single precision.
    """
    here_n, notes = replay.repeat(calls)
    board_n = calls["returned_n"].astype(np.float32)
    other = here_n.astype(np.float32).view(np.uint32) != board_n.view(np.uint32)
    other |= notes != calls["notes"].astype(int)
    return board_n[(calls["call"].astype(int) & IDLE) == 0], int(np.sum(other))
