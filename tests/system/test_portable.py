"""Every kind of fault that a Windows Python met in code written on Linux, as Linux can see it.

What only types can tell, such as a name that a module has on Linux alone, `make types` sees.
"""

import ast
import ctypes
import errno
import fcntl
import os
import re
import runpy
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
from serial.tools import list_ports
from support.messages import refusing
from support.pages.sources import FLOORS
from support.paths import ROOT
from support.peer import CLI
from support.small import model_file, passive_model

from springpot.codegen import files
from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.files import atomic_write
from springpot.codegen.model.model_file import model_bytes
from springpot.codegen.native import compiler
from springpot.host.bench.bench import _without_interrupts
from springpot.host.commands import doctor
from springpot.host.devices import dhd
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import open_device
from springpot.host.devices.serial_port import open_port
from springpot.host.native.toolchain import toolchain
from springpot.host.session import terminal
from springpot.host.study.plan import append_only_table


@pytest.fixture
def windows(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    monkeypatch.setattr(sys, "platform", "win32")
    return monkeypatch


def stand_in(monkeypatch: pytest.MonkeyPatch, name: str, **members: object) -> None:
    """A module that Windows alone has."""
    module = ModuleType(name)
    vars(module).update(members)
    monkeypatch.setitem(sys.modules, name, module)


def test_what_other_systems_answer_otherwise() -> None:
    """Paths in a folder and letters of numpy's types as data, text that would end its lines with
    CR, files that are opened while they are open, clocks that differ from that of the C."""
    found = []
    for file in (file for floor in FLOORS for file in (ROOT / floor).rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        parts = {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}
        for node in ast.walk(tree):
            wrong = isinstance(node, ast.Attribute) and node.attr == "char"
            if isinstance(node, ast.Call):
                called = ast.unparse(node.func)
                name, given = called.rpartition(".")[2], {word.arg for word in node.keywords}
                modes = {mode.value for mode in node.args if isinstance(mode, ast.Constant)}
                wrong = (
                    called in ("monotonic", "time.monotonic", "time.time")
                    or name in ("NamedTemporaryFile", "mkstemp")
                    or (name == "relative_to" and getattr(parts[node], "attr", "") != "as_posix")
                    or (name == "write_text" and not {"encoding", "newline"} <= given)
                    or (name == "open" and modes & {"w", "a", "x"} and "newline" not in given)
                )
            if wrong:
                found.append(f"{file.relative_to(ROOT)}:{node.lineno}: {ast.unparse(node)}")
    assert not found


def test_c_waits_by_one_clock() -> None:
    alone = {"sp_clock.h", "sp_link_bytes.c"}  # which waits for bytes, of each system on its own
    for file in ROOT.glob("runtime_c/*/**/*.[ch]"):
        used = re.search(r"\b(clock_\w+|nanosleep|ppoll|usleep|gettimeofday)\(", file.read_text())
        assert used is None or used[1] == "clock_ns" or file.name in alone, file


def test_what_is_to_last_is_synced_as_windows_wants(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It opens no folder, and syncs nothing that was opened for reading."""

    def opened(path: Path, mode: int) -> int:
        if path.is_dir():
            raise PermissionError(errno.EACCES, "Permission denied")
        return os.open(path, mode)

    def sync(descriptor: int) -> None:
        if fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE == os.O_RDONLY:
            raise PermissionError(errno.EACCES, "Permission denied")

    system = SimpleNamespace(**{**vars(os), "name": "nt", "open": opened, "fsync": sync})
    monkeypatch.setattr(files, "os", system)
    with atomic_write(tmp_path / "a", durable=True) as aside:
        aside.write_text("new")
    assert (tmp_path / "a").read_text() == "new"


def test_a_scene_is_emitted_whatever_the_locale(tmp_path: Path) -> None:
    name, file = "Pr\u00fcfk\u00f6rper \u67d4\u3089\u304b\u3044", model_file(tmp_path)
    (tmp_path / "scene.toml").write_text(
        f'schema = 1\nname = "{name}"\nmodel = "{file.name}"\n', encoding="utf-8"
    )
    command = [sys.executable, "-X", "utf8=0", *CLI[1:], "emit", "--scene", "scene.toml"]
    bare = {**os.environ, "LC_ALL": "C", "PYTHONCOERCECLOCALE": "0"}
    done = subprocess.run([*command, "--out", "c"], cwd=tmp_path, env=bare, capture_output=True,
                          check=False)  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert name in (tmp_path / "c/sp.c").read_text(encoding="utf-8")


def test_the_same_arrays_are_the_same_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """A zip has the number of the system that made it."""
    model = passive_model()
    here = model_bytes(model)
    monkeypatch.setattr(sys, "platform", "win32")
    assert model_bytes(model) == here


def test_the_linker_of_macos_gets_no_word_of_another(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Apple's ends at -Bsymbolic, and its `size` at -A."""
    words: list[str] = []
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setattr(compiler, "run_compiler", words.extend)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with refusing(compiler.CompilerError, "wrote no library"):
        compiler.shared_library([], [])
    assert "-shared" in words and not any("symbolic" in word for word in words)
    assert toolchain("host") is None


@pytest.mark.parametrize("loaded", [True, False])
def test_a_library_needs_no_dll_and_is_not_replaced_while_it_is_loaded(
    windows: pytest.MonkeyPatch, tmp_path: Path, loaded: bool
) -> None:
    words: list[str] = []

    def compiled(given: list[str]) -> None:
        words.extend(given)
        Path(given[given.index("-o") + 1]).write_text("ours")

    def refused(_aside: Path, library: Path) -> None:
        if loaded:
            library.write_text("of another process")
        raise PermissionError(errno.EACCES, "Access is denied")

    windows.setattr(compiler, "find_compiler", lambda: ("gcc",))
    windows.setattr(compiler, "run_compiler", compiled)
    windows.setattr(Path, "replace", refused)
    windows.setenv("XDG_CACHE_HOME", str(tmp_path))
    with nullcontext() if loaded else pytest.raises(PermissionError):
        assert compiler.shared_library([], []).read_text() == "of another process"
    assert "-static" in words


def test_what_unix_alone_has_is_not_asked_for(windows: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Masks of signals, locks by fcntl, a terminal's settings: Windows' own, or nothing."""
    windows.delattr(signal, "pthread_sigmask")
    with _without_interrupts():
        pass

    def locking(descriptor: int, _mode: int, _count: int) -> None:
        locked.append(descriptor)
        if len(locked) > 1:
            raise PermissionError(errno.EACCES, "Permission denied")

    locked: list[int] = []
    typed = list("p\xe9q")
    stand_in(windows, "fcntl")
    stand_in(windows, "termios")
    stand_in(windows, "msvcrt", locking=locking, LK_NBLCK=2,
             kbhit=lambda: bool(typed), getwch=lambda: typed.pop(0))  # fmt: skip
    with append_only_table(tmp_path / "t.csv", ["a"]):
        pass
    with refusing(UsageError, "in use"), append_only_table(tmp_path / "t.csv", ["a"]):
        pass
    windows.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: True))
    with terminal.reading_keys() as pressed:
        assert (pressed(), pressed()) == ("p\xe9q", "")


def test_a_window_that_is_closed_waits_for_the_force_to_be_zero(
    windows: pytest.MonkeyPatch,
) -> None:
    """Windows ends the process as soon as the handler, in a thread of its own, is back."""
    handlers: list[Callable[[int], int]] = []
    kernel = SimpleNamespace(SetConsoleCtrlHandler=lambda handler, _add: handlers.append(handler))
    windows.setattr(ctypes, "windll", SimpleNamespace(kernel32=kernel), raising=False)
    windows.setattr(ctypes, "WINFUNCTYPE", ctypes.CFUNCTYPE, raising=False)
    windows.setattr(signal, "SIGBREAK", signal.SIGTERM, raising=False)
    order = []

    def close() -> None:
        assert handlers[0](0) == 0  # Ctrl-C is Python's
        handlers[0](2)
        order.append("process ended")

    closing = threading.Thread(target=close)
    with pytest.raises(KeyboardInterrupt), terminal.stopping_on_sigterm():
        try:
            closing.start()
            while closing.is_alive():
                time.sleep(0.01)
        finally:
            time.sleep(0.05)
            order.append("zero force")
    closing.join()
    assert order == ["zero force", "process ended"] and len(handlers) == 2


def test_devices_go_by_the_names_of_the_system(windows: pytest.MonkeyPatch) -> None:
    def com_port(place: str, _baud: int) -> str:
        if place == "COM7":
            raise OSError(errno.EACCES, "Access is denied")
        return place

    stand_in(windows, "springpot.host.devices.com_port", ComPort=com_port)
    assert open_port("COM9", 9600) == "COM9"
    with refusing(DeviceError, "COM7", "Access is denied"):
        open_port("COM7", 9600)
    with refusing(DeviceError, "an ODrive needs the CAN of Linux"):
        open_device("odrive://slcan/COM9", DeviceRequirements(1000, 0.02, 5.0))
    with windows.context() as named:
        named.setattr(os, "name", "nt")
        names = runpy.run_path(dhd.__file__)["_NAMES"]
    assert names == ("dhd64.dll", "drd64.dll")


def test_advice_is_of_the_system(windows: pytest.MonkeyPatch) -> None:
    port = SimpleNamespace(device="COM9", description="n/a")
    windows.setattr(list_ports, "comports", lambda: [port])
    windows.setenv("PATH", "")
    advice = " ".join(row.do for row in doctor.examine() if row.what != "C compiler")
    assert "install gcc-arm-none-eabi" in advice
    assert not re.search("apt-get|usermod|rtprio|sudo", advice)
