"""A session that is left from outside says by whom, once, in words."""

import os
import signal
from pathlib import Path

import pytest
from click.testing import CliRunner
from support.peer import wait_until
from support.small import model_file, scene

from springpot.host.commands.scenes.run import run
from springpot.host.emission.emission import emit
from springpot.host.session import runner
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


def test_ctrl_c_before_it_began_is_only_that(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While the device is opened, for instance: no result of a session that never was."""
    folder = emit(scene(), model_file(tmp_path), tmp_path / "c").folder

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "open_device", interrupted)
    arguments = ["--scene", str(folder), "--device", "sim://ecoflex-00-30", "--log"]
    done = CliRunner().invoke(run, [*arguments, str(tmp_path / "a.h5")])
    assert (done.exit_code, done.stdout) == (1, "")
    assert isinstance(done.exception, SystemExit)  # click's own, of Abort; 130 from the shell
    assert not [*tmp_path.glob("a.*")]


def test_a_session_without_a_tick_leaves_no_log(tmp_path: Path) -> None:
    folder = emit(scene(), model_file(tmp_path), tmp_path / "c").folder
    with Session(folder, "sim://ecoflex-00-30", tmp_path / "a.h5", report=[].append) as session:
        pass
    assert session.result()["log"] is None
    assert session.error is None
    assert not [*tmp_path.glob("a.*")]
