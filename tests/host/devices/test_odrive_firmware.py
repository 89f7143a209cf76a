"""Which firmware a drive has, on a bus that loses frames."""

from typing import cast

import pytest

from springpot.host.devices.can_bus import CanBus
from springpot.host.devices.odrive import VERSION, Drive, DriveLimits, identifier


class ForgetfulBus:
    """A bus that loses the answers to the first questions for a version."""

    def __init__(self, lost: int) -> None:
        self.lost, self.asked = lost, 0

    def send(self, number: int, data: bytes, *, remote: bool = False) -> None:
        assert (number, data, remote) == (identifier(3, VERSION), b"", True)
        self.asked += 1

    def receive(self, until_s: float) -> tuple[int, bytes] | None:
        return (identifier(3, VERSION), bytes(8)) if self.asked > self.lost else None


@pytest.mark.parametrize(("lost", "family"), [(0, "0.6"), (1, "0.6"), (2, "0.6"), (99, "0.5")])
def test_a_lost_answer_does_not_make_another_firmware(lost: int, family: str) -> None:
    """Taken for 0.5, a drive of 0.6 seems to fail in every heartbeat and is never armed."""
    bus = ForgetfulBus(lost)
    drive = Drive(cast(CanBus, bus), 3, "odrive://x", DriveLimits(10.0, 1.0))
    assert drive._firmware() == family
    assert bus.asked <= 3
