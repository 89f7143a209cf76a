"""How a serial port is opened, who has it, and what its adapter and line can carry."""

import os
import pty
import subprocess
import sys
import termios
import types
from pathlib import Path

import pytest
import serial

from springpot.codegen.errors import DeviceError
from springpot.host.commands import doctor
from springpot.host.devices import serial_port
from springpot.host.devices.serial_port import (
    latency_timer,
    open_port,
    require_fast_adapter,
    used_by,
)


def refused(place: object) -> str:
    with pytest.raises(DeviceError) as error:
        open_port(str(place), 9600)
    return str(error.value).removeprefix(f"{place}: ")


def test_a_port_is_opened_for_one_process_and_never_waits(monkeypatch) -> None:
    far, near = pty.openpty()
    asked = []

    def opened(*arguments, **options):
        asked.append((arguments, options))
        return types.SimpleNamespace(fd=near)

    settings = termios.tcgetattr(near)
    settings[6][termios.VMIN] = 7
    termios.tcsetattr(near, termios.TCSANOW, settings)
    monkeypatch.setattr(serial_port.serial, "Serial", opened)
    monkeypatch.setattr(serial_port, "used_by", lambda place: "")
    assert open_port(os.ttyname(near), 9600).fd == near
    options = {"timeout": 0, "write_timeout": 1, "exclusive": True}
    assert asked == [((os.ttyname(near), 9600), options)]
    assert termios.tcgetattr(near)[6][termios.VMIN] in (1, b"\x01")
    assert not os.get_blocking(near)
    os.close(far)
    os.close(near)


@pytest.mark.parametrize("wrong", [OSError, serial.SerialException, ValueError])
def test_a_port_that_cannot_be_opened_is_told_with_who_has_it(tmp_path, monkeypatch, wrong) -> None:
    port = tmp_path / "port"
    port.touch()
    users = iter(["", "", "", "cat (process 7)", "dog (process 8)"])
    monkeypatch.setattr(serial_port, "used_by", lambda place: next(users))

    def fails(*_, **__):
        raise wrong("busy")

    monkeypatch.setattr(serial_port.serial, "Serial", fails)
    assert refused(port) == "cannot be opened: busy"
    assert refused(port) == "cannot be opened: in use by cat (process 7): end that program first"
    assert refused(port) == "in use by dog (process 8): end that program first"


@pytest.mark.parametrize("missing", [os.R_OK, os.W_OK])
def test_a_port_is_to_be_read_and_written(tmp_path, monkeypatch, missing: int) -> None:
    port = tmp_path / "port"
    assert refused(port).startswith("no such port: plug the device in; `springpot doctor`")
    port.touch()
    monkeypatch.setattr(serial_port.os, "access", lambda _, mode: not mode & missing)
    assert refused(port).startswith("permission denied: join the port's group (often `sudo usermod")


def test_who_has_a_port_is_found_behind_links(tmp_path: Path) -> None:
    port, link = tmp_path / "port", tmp_path / "link"
    port.touch()
    link.symlink_to(port)
    with port.open():
        assert used_by(str(link)) == ""  # oneself does not count
        other = subprocess.Popen(
            [sys.executable, "-c", "import sys; print(flush=True); sys.stdin.read()"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, pass_fds=[], text=True,
        )  # fmt: skip
        other.stdout.readline()
        assert used_by(str(link)) == ""
        other.communicate()
    code = "import sys; f = open(sys.argv[1]); print(flush=True); sys.stdin.read()"
    other = subprocess.Popen(
        [sys.executable, "-c", code, str(port)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    other.stdout.readline()
    name = Path(f"/proc/{other.pid}/comm").read_text().strip()
    assert used_by(str(link)) == f"{name} (process {other.pid})"
    other.communicate()
    assert used_by(str(link)) == ""


def test_a_latency_timer_is_looked_up_by_the_real_name(tmp_path, monkeypatch) -> None:
    assert Path("/sys/bus/usb-serial/devices") == serial_port.USB_SERIAL
    monkeypatch.setattr(serial_port, "USB_SERIAL", tmp_path)
    place = tmp_path / "by-name"
    place.symlink_to(tmp_path / "ttyUSB3")
    assert latency_timer(str(place)) is None
    require_fast_adapter(str(place), 8000)
    file = tmp_path / "ttyUSB3" / "latency_timer"
    file.parent.mkdir()
    borders = ((16, 62, True), (16, 63, False), (1, 8000, True), (2, 500, True), (2, 501, False))
    for timer_ms, rate_hz, fits in borders:
        file.write_text(f"{timer_ms}\n")
        assert latency_timer(str(place)) == (file, timer_ms)
        if fits:
            require_fast_adapter(str(place), rate_hz)
            continue
        with pytest.raises(DeviceError) as error:
            require_fast_adapter(str(place), rate_hz)
        assert str(error.value) == (
            f"{place}: the adapter's latency timer is {timer_ms} ms, {1000 // timer_ms} exchanges "
            f"a second: `echo 1 | sudo tee {file}`"
        )


@pytest.mark.parametrize(("found", "said"), [("n/a", "nothing is known"), ("a board", "a board")])
def test_the_doctor_describes_a_port(found: str, said: str) -> None:
    diagnosis = doctor._serial_port("/dev/null", found)
    assert diagnosis.found
    assert said in diagnosis.seen
