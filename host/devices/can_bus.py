"""Three ways to a CAN bus with the same methods: set a drive up, then hand the descriptor on."""

import contextlib
import os
import select
import socket
import struct
import time

import serial

from springpot.codegen.errors import DeviceError, UsageError
from springpot.host.devices.can_bridge import FRAME, REMOTE, STANDARD, CanBridge
from springpot.host.devices.serial_port import open_port
from springpot.host.devices.url import Address

BITRATES = (10_000, 20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 800_000, 1_000_000)
STUFFED_BITS = 135  # of a frame of 8 bytes with a short identifier, at worst
_QUEUE_S = 0.05  # a full queue of frames is sent in a few ms
_ANSWER_S = 0.5


class SlcanBus:
    """A Lawicel adapter: text over a serial port.

    fd: for the C loop. failure: why the bus is gone, if something says so.
    """

    failure = ""

    def __init__(self, address: Address, bitrate: int) -> None:
        """Open port and bus. Raises DeviceError where no adapter answers."""
        if bitrate not in BITRATES:
            raise UsageError(f"{address.url}: bitrate={bitrate}: use one of {BITRATES}")
        self._url = address.url
        self._port: serial.Serial = open_port(address.place, 115200)
        self.fd: int = self._port.fd
        self._pending = b""
        try:
            self._write(b"\r\rC\r")
            time.sleep(0.02)
            self._read()
            self._pending = b""
            self._write(b"S%d\rO\r" % BITRATES.index(bitrate))
            self._expect_answer()
        except BaseException:
            self.close()
            raise

    def send(self, identifier: int, data: bytes, *, remote: bool = False) -> None:
        """Send one frame of an 11-bit identifier. Raises DeviceError if the bus is gone."""
        kind = "r" if remote else "t"
        text = f"{kind}{identifier:03X}{len(data)}" + ("" if remote else data.hex().upper())
        self._write(text.encode() + b"\r")

    def receive(self, until_s: float) -> tuple[int, bytes] | None:
        """Return the next data frame, or None at that time of time.monotonic."""
        while True:
            while b"\r" in self._pending:
                line, self._pending = self._pending.split(b"\r", 1)
                if frame := _parsed(line.replace(b"\a", b"")):
                    return frame
            if time.monotonic() >= until_s:
                return None
            self._read()
            if b"\r" not in self._pending:
                time.sleep(0.0005)

    def close(self) -> None:
        with contextlib.suppress(OSError, serial.SerialException):
            self._port.write(b"\rC\r")
        self._port.close()

    def _expect_answer(self) -> None:
        until = time.monotonic() + _ANSWER_S
        while b"\r" not in self._pending:
            if b"\a" in self._pending or time.monotonic() > until:
                raise DeviceError(
                    f"{self._url}: no slcan adapter answers there: check the port, and that the "
                    "adapter's firmware is a Lawicel (slcan) one"
                )
            self._read()
            time.sleep(0.001)

    def _read(self) -> None:
        try:
            self._pending += self._port.read(4096)
        except (OSError, serial.SerialException, TypeError) as error:
            raise DeviceError(f"{self._url}: went away ({error}): plug it in") from None

    def _write(self, content: bytes) -> None:
        try:
            self._port.write(content)
        except (OSError, serial.SerialException) as error:
            raise DeviceError(f"{self._url}: went away ({error}): plug it in") from None


class SocketBus:
    """A raw socket of the kernel's CAN, or one that carries the same frames."""

    @property
    def failure(self) -> str:
        return ""

    def __init__(self, address: Address, raw: socket.socket | None = None) -> None:
        """Bind to the interface; raw: a socket that carries struct can_frame already."""
        self._url = address.url
        try:
            self._raw = raw or socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
            if raw is None:
                self._raw.bind((address.place,))
        except OSError as error:
            raise DeviceError(
                f"{self._url}: {error.strerror}: the kernel needs CAN and the interface must be up "
                f"(`sudo ip link set {address.place} up type can bitrate 1000000`)"
            ) from None
        self._raw.setblocking(False)
        self.fd = self._raw.fileno()

    def send(self, identifier: int, data: bytes, *, remote: bool = False) -> None:
        flag = REMOTE if remote else 0
        if not select.select([], [self.fd], [], _QUEUE_S)[1]:
            raise DeviceError(
                f"{self._url}: its queue stays full, nobody on the bus answers: check the wiring, "
                "the drive's power and ?bitrate="
            )
        try:
            os.write(self.fd, FRAME.pack(identifier | flag, len(data), data.ljust(8, b"\0")))
        except OSError as error:
            raise self._gone(error.strerror or "gone") from None

    def receive(self, until_s: float) -> tuple[int, bytes] | None:
        while True:
            try:
                identifier, size, data = FRAME.unpack(os.read(self.fd, FRAME.size))
            except BlockingIOError:
                if time.monotonic() >= until_s:
                    return None
                time.sleep(0.0005)
                continue
            except (OSError, struct.error):
                raise self._gone("gone") from None
            if identifier <= STANDARD:
                return identifier, data[:size]

    def close(self) -> None:
        self._raw.close()

    def _gone(self, reason: str) -> DeviceError:
        return DeviceError(f"{self._url}: {reason}: bring the interface up")


class PythonCanBus(SocketBus):
    """Any other interface of python-can, behind a socket of the same kind."""

    def __init__(self, address: Address, bitrate: int) -> None:
        self._bridge = CanBridge(address, bitrate)
        super().__init__(address, self._bridge.near)

    @property
    def failure(self) -> str:
        return self._bridge.failure

    def close(self) -> None:
        self._bridge.close()
        super().close()

    def _gone(self, reason: str) -> DeviceError:
        return DeviceError(f"{self._url}: {self.failure or reason}: check the bus")


def open_bus(address: Address, bitrate: int) -> SlcanBus | SocketBus:
    """Open the bus of an odrive:// address."""
    if address.interface == "slcan":
        return SlcanBus(address, bitrate)
    if address.interface == "socketcan":
        return SocketBus(address)
    return PythonCanBus(address, bitrate)


def _parsed(line: bytes) -> tuple[int, bytes] | None:
    """A data frame out of one line of the adapter; None for its answers and for damage."""
    try:
        size = int(line[4:5], 16)
        if line[:1] != b"t" or size > 8 or len(line) not in (5 + 2 * size, 9 + 2 * size):
            return None
        return int(line[1:4], 16), bytes.fromhex(line[5 : 5 + 2 * size].decode())
    except ValueError:
        return None
