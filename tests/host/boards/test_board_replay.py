"""A replay through a board begins again where frames get lost; each sample's force is compared."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from springpot.codegen.errors import DeviceError
from springpot.host.boards.replay import BoardReplay
from springpot.host.devices.wire import Frame


class Board:
    """Answers each sample; in the first `faulty` tries one answer is damaged."""

    def __init__(self, faulty: int) -> None:
        self.address = SimpleNamespace(url="serial:///dev/board")
        self.receiver = SimpleNamespace(crc_errors=0, gaps=0)
        self.faulty, self.tries, self._sample = faulty, 0, 0
        self._waiting: list[Frame] = []

    def command(self, action: str) -> None:
        assert action == "REPLAY"
        self.tries += 1
        self._sample = 0

    def send(self, name: str, **values: float) -> None:
        self._sample += 1
        if self._sample == 3 and self.tries <= self.faulty:
            self.receiver.crc_errors += 1
        else:
            self._waiting = [
                Frame("rendered", 0, {"force_n": self.force_n(**values), "notes": 1}, False)
            ]

    def frames(self) -> list[Frame]:
        frames, self._waiting = self._waiting, []
        return frames

    def force_n(self, position_m: float, velocity_mps: float) -> float:
        return 2 * position_m + velocity_mps


@pytest.mark.parametrize("faulty", [0, 2])
def test_a_lost_frame_begins_again(faulty: int) -> None:
    board = Board(faulty)
    force_n, notes = BoardReplay(board).run(np.arange(5.0), np.ones(5))  # type: ignore[arg-type]
    assert board.tries == faulty + 1
    np.testing.assert_array_equal(force_n, 2 * np.arange(5.0) + 1)
    assert notes.tolist() == [1] * 5


class Here:
    """This machine's C: what the board gives, but for a bit of one force and one note."""

    def run(self, position_m: Any, velocity_mps: Any) -> tuple[Any, Any]:
        assert position_m.dtype == np.float32
        force_n, notes = 2 * position_m + velocity_mps, np.ones(5, dtype=int)
        force_n[1] = np.nextafter(force_n[1], np.float32(9))
        notes[3] += 8
        return force_n, notes


def test_a_bit_is_a_difference() -> None:
    replay: Any = BoardReplay(Board(0))  # type: ignore[arg-type]
    force_n, others = replay.compared(Here(), np.arange(5.0), np.ones(5))
    np.testing.assert_array_equal(force_n, 2 * np.arange(5.0) + 1)
    assert others == 2


def test_a_bad_line_is_told() -> None:
    with pytest.raises(
        DeviceError, match=r"a frame was lost in each of 5 tries \(5 so far\): check the cable"
    ):
        BoardReplay(Board(99)).run(np.arange(5.0), np.zeros(5))  # type: ignore[arg-type]
