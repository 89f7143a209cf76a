"""A replay through a board whose frames get lost begins again."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from springpot.codegen.errors import DeviceError
from springpot.host.boards.replay import BoardReplay
from springpot.host.devices.lines.wire import Frame, constant


class Board:
    """Answers each sample, after an idle call; in the first `faulty` tries one frame is lost."""

    def __init__(self, faulty: int) -> None:
        self.address = SimpleNamespace(url="serial:///dev/board")
        self.receiver = SimpleNamespace(crc_errors=0, gaps=0)
        self.faulty, self.tries, self._sample = faulty, 0, 0
        self._waiting: list[Frame] = []

    def command(self, action: str) -> None:
        assert action == "RESET"
        self.tries += 1
        self._sample = 0

    def send(self, name: str, **values: float) -> None:
        self._sample += 1
        idle = {"call": constant("IDLE"), "position_m": 0.0, "velocity_mps": 0.0, "dt_s": 1e-3,
                "force_n": 0.0, "notes": 1}  # fmt: skip
        made = {**idle, **values, "call": 0, "force_n": 1.0, "notes": 0}
        if self._sample == 3 and self.tries <= self.faulty:
            self.receiver.gaps += 1  # the idle call before this sample never came
            self._waiting = [self._frame(made)]
        else:
            self._waiting = [self._frame(idle), self._frame(made)]

    def frames(self) -> list[Frame]:
        frames, self._waiting = self._waiting, []
        return frames

    @staticmethod
    def _frame(values: dict[str, Any]) -> Frame:
        return Frame("rendered", 0, values, False)


@pytest.mark.parametrize("faulty", [0, 2])
def test_a_lost_frame_begins_again(faulty: int) -> None:
    board = Board(faulty)
    calls = BoardReplay(board).run(np.arange(5.0), np.zeros(5))  # type: ignore[arg-type]
    assert board.tries == faulty + 1
    assert len(calls["call"]) == 10
    np.testing.assert_array_equal(calls["input_m"][1::2], np.arange(5.0))


class Prompt(Board):
    """Answers a sample together with the idle call of the period after it."""

    def send(self, name: str, **values: float) -> None:
        super().send(name, **values)
        self._waiting.reverse()


def test_calls_that_come_with_an_answer_are_kept() -> None:
    calls = BoardReplay(Prompt(0)).run(np.arange(5.0), np.zeros(5))  # type: ignore[arg-type]
    idle = calls["call"].astype(int) & constant("IDLE") != 0
    np.testing.assert_array_equal(idle, [False, True] * 4 + [False])


def test_a_bad_line_is_told() -> None:
    with pytest.raises(DeviceError, match=r"a frame was lost \(5 so far\).*check the cable"):
        BoardReplay(Board(99)).run(np.arange(5.0), np.zeros(5))  # type: ignore[arg-type]
