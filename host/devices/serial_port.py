"""Serial ports: opened for one process, what can be wrong is one line each."""

import os
import sys
from pathlib import Path

import serial

from springpot.codegen.errors import DeviceError

USB_SERIAL = Path("/sys/bus/usb-serial/devices")


def require_port(place: str) -> None:
    """Raise DeviceError for a port that is not there, or not ours to open."""
    if not Path(place).exists():
        raise DeviceError(
            f"{place}: no such port: plug the device in; `springpot doctor` lists all"
        )
    if not os.access(place, os.R_OK | os.W_OK):
        raise DeviceError(
            f"{place}: permission denied: join the port's group (often `sudo usermod -aG dialout "
            "$USER`), then log in again"
        )
    if user := used_by(place):
        raise DeviceError(f"{place}: in use by {user}: end that program first")


def open_port(place: str, baud: int) -> serial.Serial:
    """Open a port that nobody else uses; reads return at once. Raises DeviceError."""
    if sys.platform == "win32":
        from springpot.host.devices.com_port import ComPort

        try:
            return ComPort(place, baud)
        except OSError as error:
            raise DeviceError(f"{place}: cannot be opened: {error.strerror}") from None
    require_port(place)
    try:
        port = serial.Serial(place, baud, timeout=0, write_timeout=1, exclusive=True)
    except (OSError, serial.SerialException, ValueError) as error:
        user = used_by(place)
        reason = f"in use by {user}: end that program first" if user else str(error)
        raise DeviceError(f"{place}: cannot be opened: {reason}") from None
    import termios

    settings = termios.tcgetattr(port.fd)
    settings[6][termios.VMIN] = 1  # so that "nothing there" and "gone" read differently
    termios.tcsetattr(port.fd, termios.TCSANOW, settings)
    os.set_blocking(port.fd, False)
    return port


def used_by(place: str) -> str:
    """Return name and number of another process that has the port open, or nothing."""
    port = os.path.realpath(place)
    for process in Path("/proc").glob("[0-9]*"):
        if process.name == str(os.getpid()):
            continue
        try:
            if any(str(fd.readlink()) == port for fd in (process / "fd").iterdir()):
                return f"{(process / 'comm').read_text().strip()} (process {process.name})"
        except OSError:
            continue
    return ""


def latency_timer(place: str) -> tuple[Path, int] | None:
    """File and ms of a USB adapter's latency timer, where it has one."""
    file = USB_SERIAL / Path(os.path.realpath(place)).name / "latency_timer"
    return (file, int(file.read_text(encoding="utf-8"))) if file.exists() else None


def require_fast_adapter(place: str, rate_hz: float) -> None:
    """Raise DeviceError where the adapter gathers bytes for longer than a period."""
    timer = latency_timer(place)
    if timer is not None and timer[1] * 1e-3 > 1 / rate_hz and timer[1] > 1:
        file, ms = timer
        raise DeviceError(
            f"{place}: the adapter's latency timer is {ms} ms, {1000 // ms} exchanges a second: "
            f"`echo 1 | sudo tee {file}`"
        )
