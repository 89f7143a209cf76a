"""A CAN bus as a socket of struct can_frame, for setting a drive up and then for the C loop."""

import contextlib
import json
import select
import socket
import struct
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

from springpot.codegen.errors import DeviceError
from springpot.codegen.types import JsonObject
from springpot.host.devices.can_bridge import FRAME, REMOTE, STANDARD
from springpot.host.devices.drivers import Address

STUFFED_BITS = 135  # of a frame of 8 bytes with a short identifier, at worst
_QUEUE_S = 0.05  # a full queue of frames is sent in a few ms
_OPEN_S, _LAST_WORDS_S = 10.0, 0.5
# Less than Linux grants: about six frames then wait for the bus. More would be forces of long ago.
_WAITING_BYTES = 1
BRIDGE = Path(__file__).with_name("can_bridge.py")


class CanBus:
    """The kernel's CAN by its own socket; any other interface of python-can by a bridge to it.

    fd: of the socket, which does not block. A bus that is too slow fills it; one that fails closes
    it.
    """

    def __init__(self, address: Address, bitrate: int) -> None:
        """Open the bus. Raises DeviceError with the reason of the system or of python-can."""
        self._url, self._bridge, self._failure = address.url, None, ""
        if address.interface == "socketcan":
            self._socket, self._advice = _kernel_socket(address), "bring the interface up"
        else:
            self._advice = "check the bus"
            self._socket, self._bridge = _bridged(address, bitrate)
            self._socket.settimeout(_OPEN_S)
            opened = b""
            with contextlib.suppress(TimeoutError):
                opened = self._socket.recv(FRAME.size)
            if not opened:
                self.close()
                raise self._gone("does not open")
        self._socket.setblocking(False)
        self.fd = self._socket.fileno()

    @property
    def failure(self) -> str:
        """Reason why the bus is gone, if python-can gives one."""
        if self._bridge is not None and self._bridge.returncode is None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._failure = self._bridge.communicate(timeout=_LAST_WORDS_S)[0].strip()
        return self._failure

    def send(self, identifier: int, data: bytes, *, remote: bool = False) -> None:
        """Send one frame of an 11-bit identifier. Raises DeviceError if the bus is gone or full."""
        frame = FRAME.pack(identifier | (REMOTE if remote else 0), len(data), data)
        try:
            if not select.select([], [self.fd], [], _QUEUE_S)[1]:
                raise BlockingIOError
            self._socket.send(frame)
        except BlockingIOError:
            raise DeviceError(
                f"{self._url}: its queue stays full, nobody on the bus answers: check the wiring, "
                "the drive's power and ?bitrate="
            ) from None
        except OSError as error:
            raise self._gone(error.strerror or "gone") from None

    def receive(self, until_s: float) -> tuple[int, bytes] | None:
        """Return the next data frame, or None at that time of time.perf_counter."""
        while True:
            try:
                identifier, size, data = FRAME.unpack(self._socket.recv(FRAME.size))
            except BlockingIOError:
                if not select.select([self.fd], [], [], max(0.0, until_s - time.perf_counter()))[0]:
                    return None
                continue
            except (OSError, struct.error):
                raise self._gone("gone") from None
            if identifier <= STANDARD:
                return identifier, data[:size]

    def close(self) -> None:
        """Leave the bus after the last frame."""
        with contextlib.suppress(OSError):  # the other end was closed
            self._socket.shutdown(socket.SHUT_WR)
        if self._bridge is not None and not self.failure and self._bridge.returncode is None:
            self._bridge.kill()
            self._bridge.communicate()
        self._socket.close()

    def _gone(self, reason: str) -> DeviceError:
        return DeviceError(f"{self._url}: {self.failure or reason}: {self._advice}")


def _kernel_socket(address: Address) -> socket.socket:
    """Open a raw socket on a CAN interface of the kernel. Raises DeviceError."""
    if sys.platform != "linux":  # mypy reads no further there
        raise NotImplementedError
    try:
        raw = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        raw.bind((address.place,))
    except OSError as error:
        raise DeviceError(
            f"{address.url}: {error.strerror}: the kernel needs CAN and the interface must be up "
            f"(`sudo ip link set {address.place} up type can bitrate 1000000`)"
        ) from None
    return raw


def _bridged(address: Address, bitrate: int) -> tuple[socket.socket, "subprocess.Popen[str]"]:
    """Return a socket, and the process that carries its frames to and from a bus of python-can."""
    if sys.platform != "linux":  # mypy reads no further there
        raise NotImplementedError
    if find_spec("can") is None:
        raise ModuleNotFoundError("No module named 'can'", name="can")
    bus: JsonObject = {"interface": address.interface, "channel": address.place}
    if address.interface == "udp_multicast":
        bus |= {"hop_limit": 0, "port": address.whole("port", 43113, 1024, 65535)}
    else:
        bus["bitrate"] = bitrate
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _WAITING_BYTES)
    with theirs:
        program = [sys.executable, "-P", str(BRIDGE)]
        process = subprocess.Popen(
            [*program, json.dumps(bus), str(theirs.fileno())],
            pass_fds=[theirs.fileno()], stdout=subprocess.PIPE, text=True,
            start_new_session=True,  # Ctrl-C and a closed terminal are ours: we send zero force
        )  # fmt: skip
    return ours, process
