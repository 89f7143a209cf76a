"""A session that is left from outside says by whom, once, in words."""

import os
import signal
from pathlib import Path

import pytest
from support.peer import wait_until
from support.small import model_file, scene

from springpot.host.emission.emission import emit
from springpot.host.session.session import Session
from springpot.host.session.terminal import stopping_on_sigterm


@pytest.mark.parametrize(
    ("number", "who"), [(signal.SIGTERM, "SIGTERM"), (signal.SIGINT, "Ctrl-C")]
)
def test_a_signal_is_named(tmp_path: Path, number: int, who: str) -> None:
    folder = emit(scene(), model_file(tmp_path), tmp_path / "c").folder
    told: list[str] = []
    session = Session(folder, "sim://ecoflex-00-30", tmp_path / "a.h5", report=told.append)
    with pytest.raises(KeyboardInterrupt), stopping_on_sigterm(), session:
        session.start()
        wait_until(lambda: session.runner.state.ticks > 10, 20, "no tick")
        os.kill(os.getpid(), number)
        session.wait(20)  # the signal is taken here at the latest
    line = f"interrupted by {who}: zero force was sent"
    assert [item for item in told if "interrupt" in item.lower()] == [line]
    assert session.result()["stopped"] == line
