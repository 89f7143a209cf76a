"""How a session ends: by whom, whether anything could be felt then, and after how many ticks."""

import os
import signal
from pathlib import Path

import pytest
from click.testing import CliRunner
from support.peer import peer, wait_until

from springpot import Session
from springpot.host.cli import exit_status
from springpot.host.commands.run import run
from springpot.host.native.loop_library import Stop, empty_rows
from springpot.host.recording.indentation import trip_error
from springpot.host.session import runner
from springpot.host.session.loop import LoopSettings, LoopState
from springpot.host.session.outcome import expected_ticks, fault_at_end, why_stopped
from springpot.host.session.terminal import stopping_on_sigterm

SETTINGS = LoopSettings(period_s=0.001, seconds=2.0)


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
    ("state", "samples", "fault"),
    [
        ({"elapsed_s": 1.0}, 900, ""),
        ({"elapsed_s": 0.01}, 0, ""),  # ended before a sample could come
        ({"elapsed_s": 1.0, "latched": 1}, 0, "no sample ever came"),
        ({"elapsed_s": 1.0, "latched": 1, "connected": 0}, 9, "the device was gone: plug it in"),
        ({"elapsed_s": 1.0, "latched": 1}, 9, ""),
    ],
)
@pytest.mark.parametrize("reason", [Stop.TIME, Stop.ASKED, Stop.BUTTON, Stop.ENDED])
def test_a_device_that_was_not_there_is_said(
    state: dict[str, float], samples: int, fault: str, reason: Stop
) -> None:
    end = LoopState(reason=reason, **state)  # type: ignore[arg-type]
    found = fault_at_end(end, samples)
    assert found.startswith(fault) and bool(found) == bool(fault)
    line, error = why_stopped(end, empty_rows(1)[0], SETTINGS, found)
    assert error is None  # a press or a test may end like that; for a session it is an error
    assert line.endswith(found)
    latched = "; the watchdog had tripped and the force was zero" in line
    assert latched == (not fault and "latched" in state)


@pytest.mark.parametrize(
    ("reason", "elapsed_s", "count"),
    [
        (Stop.ASKED, 0.0, 0),
        (Stop.ASKED, 0.0004, 1),  # the first tick is at the start
        (Stop.ASKED, 2.9181, 2919),
        (Stop.ENDED, 2.9181, 2919),
        (Stop.TIME, 1.9998, 2000),
        (Stop.TIME, 2.0003, 2000),
    ],
)
def test_ticks_that_began_are_expected(reason: Stop, elapsed_s: float, count: int) -> None:
    assert expected_ticks(LoopState(reason=reason, elapsed_s=elapsed_s), SETTINGS) == count


def test_a_trip_names_who_was_late() -> None:
    silent = trip_error("serial://x", LoopState(watchdog_trips=1, latched=1))
    assert "x: silent for 20 ms while pressing" in str(silent)
    busy = trip_error("serial://x", LoopState(watchdog_trips=1, tripped=1, late=36))
    assert "x: switched its motor off: no force reached it for 20 ms" in str(busy)
    assert "36 periods began late: end other programs" in str(busy)


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


def test_ctrl_c_before_it_began_is_only_that(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While the device is opened, for instance: no result of a session that never was."""

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "open_device", interrupted)
    arguments = ["--scene", str(folder), "--device", "sim://ecoflex-00-30", "--log"]
    done = CliRunner().invoke(run, [*arguments, str(tmp_path / "a.h5")])
    assert (done.exit_code, done.stdout) == (1, "")
    assert isinstance(done.exception, SystemExit)  # click's own, of Abort; 130 from the shell
    assert not [*tmp_path.glob("a.*")]


def test_a_session_without_a_tick_leaves_no_log(folder: Path, tmp_path: Path) -> None:
    with Session(folder, "sim://ecoflex-00-30", tmp_path / "a.h5", report=[].append) as session:
        pass
    assert session.result()["log"] is None
    assert session.error is None
    assert not [*tmp_path.glob("a.*")]
