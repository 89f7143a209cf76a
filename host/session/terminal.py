"""Watching a running loop: a live line, the keys that stop, pause and reset, signals as a stop."""

import contextlib
import math
import os
import select
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType

from rich.live import Live
from rich.text import Text

from springpot.codegen.errors import UsageError
from springpot.host.output import print_line, progress_console
from springpot.host.session.runner import Progress, SessionRunner

_KEYS = "q stop, p pause, r reset"
_CTRL_CLOSE = 2  # of a console: its window, or the session of its user, ends
_PATIENCE_S = 4.0  # Windows itself waits 5 s for a window that was closed
# A kill, a closed terminal, Ctrl-\ and, on Windows, Ctrl-Break ask for the same thing.
_ENDING = tuple(
    getattr(signal, name)
    for name in ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK")
    if hasattr(signal, name)
)


def watch(runner: SessionRunner) -> None:
    """Show progress and obey keys until the loop ends."""
    with reading_keys() as pressed, Live(console=progress_console, transient=True) as live:
        for progress in runner.watch():
            for key in pressed():
                handle_key(runner, key)
            live.update(Text(progress_line(progress)))


def handle_key(runner: SessionRunner, key: str) -> None:
    """Do what a key means: q, escape or space stop, p pauses and goes on, r resets."""
    if key in "q \x1b":
        runner.stop()
    elif key == "p":
        if runner.state.paused:
            runner.resume()
        else:
            runner.pause()
    elif key == "r":
        runner.reset()


def progress_line(progress: Progress, keys: str = _KEYS) -> str:
    """One line: rate, depth, force, late ticks, age of the sample."""
    state = progress.state
    age = "no sample" if math.isnan(progress.age_s) else f"sample {1e3 * progress.age_s:.2f} ms old"
    words = [
        f"{progress.elapsed_s:6.1f} s",
        f"{progress.rate_hz:5.0f} Hz",
        f"{1e3 * progress.depth_m:7.2f} mm",
        f"{progress.force_n:6.2f} N",
        f"{state.late} late",
        age,
    ]
    flags = {"paused": state.paused, "FORCE ZERO, reset with r": state.latched or state.tripped,
             "waiting for the device": not state.connected}  # fmt: skip
    return "  ".join([*words, *(name for name, on in flags.items() if on), f"[{keys}]"])


@contextlib.contextmanager
def _outliving_its_window() -> Iterator[None]:
    """Take a console window of Windows that is closed as Ctrl-Break, and end before it does.

    Python hears of it too, but Windows ends a process as soon as the last handler has returned.
    """
    if sys.platform == "win32":
        import ctypes

        over = threading.Event()

        def closed(event: int) -> int:
            if event < _CTRL_CLOSE:
                return 0  # Ctrl-C and Ctrl-Break are Python's
            signal.raise_signal(signal.SIGBREAK)
            return int(over.wait(_PATIENCE_S))

        handler = ctypes.WINFUNCTYPE(ctypes.c_int, ctypes.c_uint)(closed)
        ctypes.windll.kernel32.SetConsoleCtrlHandler(handler, 1)
        try:
            yield
        finally:
            over.set()
            ctypes.windll.kernel32.SetConsoleCtrlHandler(handler, 0)
    else:
        yield


@contextlib.contextmanager
def stopping_on_sigterm() -> Iterator[None]:
    """Leave with statements, and so end with zero force, when the process is asked to end.

    By SIGTERM, SIGHUP or SIGQUIT, once: more of them do not interrupt the end. A signal that was
    ignored stays ignored, as nohup wants. A terminal that was closed is written to no more.
    """
    terminals = [stream for stream in (0, 1, 2) if os.isatty(stream)]

    def leave(number: int, _frame: FrameType | None) -> None:
        for again in before:
            signal.signal(again, signal.SIG_IGN)
        if signal.Signals(number).name == "SIGHUP":
            nowhere = os.open(os.devnull, os.O_RDWR)
            for stream in terminals:  # an error of theirs must not stop the end
                os.dup2(nowhere, stream)
            os.close(nowhere)
        raise KeyboardInterrupt(signal.Signals(number).name)  # Python's own of Ctrl-C says nothing

    before = {
        number: handler
        for number in _ENDING
        if (handler := signal.getsignal(number)) != signal.SIG_IGN
    }
    for number in before:
        signal.signal(number, leave)
    try:
        with _outliving_its_window():
            yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextlib.contextmanager
def reading_keys() -> Iterator[Callable[[], str]]:
    """Yield what returns the keys pressed since its last call; none without a terminal."""
    if not sys.stdin.isatty():
        yield str
        return
    if sys.platform == "win32":
        yield _pressed
        return
    import termios
    import tty

    before = termios.tcgetattr(sys.stdin)
    tty.setcbreak(sys.stdin)
    try:
        yield _pressed
    finally:
        with contextlib.suppress(termios.error):  # the terminal was closed
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)


def wait_for_enter(line: str) -> None:
    """Ask for something that a person does, until Enter. Raises UsageError if nobody answers."""
    print_line(line)
    if not sys.stdin.readline():
        raise UsageError("nobody presses Enter: run it in a terminal")


def _pressed() -> str:
    """Return the keys that were pressed, without waiting."""
    if sys.platform == "win32":
        import msvcrt

        return "".join(iter(lambda: msvcrt.getwch() if msvcrt.kbhit() else "", ""))
    pressed = b""
    with contextlib.suppress(OSError):  # a terminal that was closed gives none
        while select.select([sys.stdin], [], [], 0)[0] and (
            keys := os.read(sys.stdin.fileno(), 64)
        ):
            pressed += keys
    return pressed.decode(errors="replace")
