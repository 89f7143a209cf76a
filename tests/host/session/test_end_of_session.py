"""How a session ends: by whom, whether anything could be felt then, and after how many ticks."""

import os
import signal
from pathlib import Path

import pytest
from support.peer import peer, wait_until

from springpot import Session
from springpot.host.cli import exit_status
from springpot.host.session.terminal import stopping_on_sigterm


def test_a_session_is_ended_while_its_device_is_gone(folder: Path) -> None:
    told: list[str] = []
    with peer("serial_device", "--gone-after", 0.2) as device:
        session = Session(folder, device.url, seconds=60, reconnect_s=60, report=told.append)
        with session:
            session.start()
            wait_until(lambda: any("waiting 60 s" in line for line in told), 20, "never gone")
            session.stop()
        returning = session._supervisor._returning
        returning.join(10)
        assert not returning.is_alive()
    line = "stopped by the user; the device was gone: plug it in and start again"
    assert session.line == told[-1] == line
    assert exit_status(session.error) == 5
    assert not any("gone for" in line for line in told)


@pytest.mark.parametrize(
    ("number", "who"), [(signal.SIGTERM, "SIGTERM"), (signal.SIGINT, "Ctrl-C")]
)
def test_a_signal_is_named(folder: Path, tmp_path: Path, number: int, who: str) -> None:
    told: list[str] = []
    session = Session(folder, "sim://ecoflex-00-30", tmp_path / "a.h5", report=told.append)
    with pytest.raises(KeyboardInterrupt), stopping_on_sigterm(), session:
        session.start()
        wait_until(lambda: session.state.ticks > 10, 20, "no tick")
        os.kill(os.getpid(), number)
        session.wait(20)  # the signal is taken here at the latest
    line = f"interrupted by {who}: zero force was sent"
    assert [item for item in told if "interrupt" in item.lower()] == [line]
    assert session.result()["stopped"] == line


def test_a_session_without_a_tick_leaves_no_log(folder: Path, tmp_path: Path) -> None:
    with Session(folder, "sim://ecoflex-00-30", tmp_path / "a.h5", report=[].append) as session:
        pass
    assert session.result()["log"] is None
    assert session.error is None
    assert not [*tmp_path.glob("a.*")]
