"""How a session ends: by whom, with zero force, whoever asks and how, and after how many ticks."""

import contextlib
import json
import os
import pty
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner
from support.peer import CLI, peer, wait_until
from support.small_study import SOFT, planned_study

from springpot import Session
from springpot.codegen.errors import DeviceError
from springpot.host.cli import exit_status, springpot
from springpot.host.commands import COMMANDS
from springpot.host.session import runner
from springpot.host.session.terminal import stopping_on_sigterm
from springpot.trainer.recordings.recording_file import read_recording

ENDING = (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
DEVICE = "serial:///dev/none"
# The first terminal that the leader of a new session opens is its own: closed, it hangs up.
ON_A_TERMINAL = f"import os; os.close(os.open(os.ttyname(0), os.O_RDWR)); {CLI[-1]}"


@pytest.fixture(autouse=True)
def _signals_are_heard() -> Iterator[None]:
    """Also where the tests run under nohup or in the background, which programs inherit."""
    before = {number: signal.signal(number, signal.SIG_DFL) for number in ENDING}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def _study(folder: Path) -> list[object]:
    return ["study", "run", planned_study(folder, 1).path, "--participant", "01"]


def _run(folder: Path) -> list[object]:
    _study(folder)
    return ["run", "--scene", folder / f"{SOFT}.toml", "--log", folder / "a.h5"]


MOVING = {
    "run": _run,
    "record": lambda folder: ["record", "--protocol", "validation", "--out", folder / "out"],
    "study": _study,
}


@pytest.mark.few(1)
@pytest.mark.parametrize("command", MOVING)
def test_every_command_that_moves_a_device_is_left_with_statements(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    """From before its device is opened on: each signal raises what Ctrl-C raises."""
    raised: list[str] = []

    def opened(*_: object) -> None:
        handlers = {number: signal.getsignal(number) for number in ENDING}
        for number, handler in handlers.items():
            try:
                if callable(handler):
                    handler(number, None)
            except KeyboardInterrupt as asked:
                raised.append(str(asked))
        raise DeviceError("looked")

    monkeypatch.setattr(runner, "open_device", opened)
    arguments = [str(item) for item in (*MOVING[command](tmp_path), "--device", DEVICE)]
    with _same_terminal():
        CliRunner().invoke(springpot, arguments)
    assert command in COMMANDS and raised == [number.name for number in ENDING]


@contextlib.contextmanager
def _same_terminal() -> Iterator[None]:
    """What a hangup redirects is the test's own again afterwards."""
    kept = [os.dup(stream) for stream in (0, 1, 2)]
    try:
        yield
    finally:
        for stream, copy in enumerate(kept):
            os.dup2(copy, stream)
            os.close(copy)


@pytest.mark.parametrize("first", ENDING)
def test_what_asks_again_does_not_interrupt_the_end(first: signal.Signals) -> None:
    """A shell and the system may both tell of a closed terminal."""
    before = [signal.getsignal(number) for number in ENDING]
    asked = pytest.raises(KeyboardInterrupt, match=first.name)
    with _same_terminal(), asked, stopping_on_sigterm():
        try:
            signal.raise_signal(first)
        finally:
            for number in ENDING:
                signal.raise_signal(number)
    assert [signal.getsignal(number) for number in ENDING] == before


def test_an_ignored_hangup_stays_ignored() -> None:
    """As nohup wants."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with stopping_on_sigterm():
            signal.raise_signal(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.few(1)
@pytest.mark.parametrize("as_json", [False, True])
def test_a_session_whose_terminal_is_closed_ends_as_by_sigterm(
    tmp_path: Path, folder: Path, as_json: bool
) -> None:
    """Its keys, its line and its table have nowhere to go: zero, a whole log, status 0."""
    log = tmp_path / "a.h5"
    device = ["--device", "sim://ecoflex-00-30?hand=mid", "--log", log]
    arguments = ["run", "--scene", folder, *device, *(["--json"] if as_json else [])]
    command = [sys.executable, "-c", ON_A_TERMINAL, *map(str, arguments)]
    screen, terminal = pty.openpty()
    with subprocess.Popen(
        command, stdin=terminal, stdout=terminal, stderr=terminal, start_new_session=True
    ) as host:
        os.close(terminal)
        journal = log.with_suffix(".journal")
        wait_until(lambda: journal.exists() and journal.stat().st_size > 3 * 4096, 60, "no log")
        os.close(screen)
        assert host.wait(60) == 0
    end = read_recording(log).details["end"]
    assert end["stopped"] == "interrupted by SIGHUP: zero force was sent", json.dumps(end)
    assert not journal.exists()


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
    assert session.line == told[-1] == line and exit_status(session.error) == 5
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
    assert session.result()["log"] is None and session.error is None and not [*tmp_path.glob("a.*")]
