"""Any interface of python-can as a socket: two threads carry its frames to and from the C loop."""

import contextlib
import socket
import struct
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from springpot.codegen.errors import DeviceError
from springpot.codegen.types import JsonObject
from springpot.host.devices.url import Address

FRAME = struct.Struct("=IB3x8s")  # struct can_frame
REMOTE, STANDARD = 0x40000000, 0x7FF  # of its identifier: a flag, and the bits of a short one
_RECEIVE_S = 0.1  # how soon a thread that waits for a frame sees that the bridge was closed
_JOIN_S = 1.0
# Less than Linux grants: about six frames then wait for the bus. More would be forces of long ago.
_WAITING_BYTES = 1


class CanBridge:
    """near: a socket that carries what comes and goes on a bus of python-can as struct can_frame.

    Only data frames with short identifiers come. A bus that is too slow fills the socket, which
    then refuses. A bus that fails closes it: whoever reads it finds the device gone; `failure`
    is python-can's reason.
    """

    def __init__(self, address: Address, bitrate: int) -> None:
        """Open the bus. Raises DeviceError with python-can's own reason."""
        self._bus = python_can_bus(address, bitrate)
        self.near, self._far = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.near.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _WAITING_BYTES)
        self.failure = ""
        self._over = threading.Event()
        self._threads = [
            threading.Thread(target=self._carry, args=(frames,), daemon=True)
            for frames in (self._from_bus, self._to_bus)
        ]
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """Leave the bus after the last frame; `near` is the caller's to close."""
        with contextlib.suppress(OSError):  # closed before
            self.near.shutdown(socket.SHUT_WR)
        for thread in self._threads:
            thread.join(_JOIN_S)
        self._far.close()
        self._bus.shutdown()

    def _carry(self, frames: Callable[[], None]) -> None:
        """Carry frames in one direction until there are no more, or something fails."""
        try:
            frames()
        except Exception as error:  # each interface has errors of its own
            self.failure = self.failure or " ".join(str(error).split())
        finally:
            self._over.set()
            with contextlib.suppress(OSError):  # the other end was closed already
                self._far.shutdown(socket.SHUT_RDWR)

    def _from_bus(self) -> None:
        while not self._over.is_set():
            message = self._bus.recv(_RECEIVE_S)
            if message is None or message.is_extended_id or message.is_fd:
                continue
            if message.is_error_frame or message.is_remote_frame:
                continue
            data = bytes(message.data)
            frame = FRAME.pack(message.arbitration_id, len(data), data)
            with contextlib.suppress(BlockingIOError):  # nobody reads: it is full of samples
                self._far.send(frame, socket.MSG_DONTWAIT)

    def _to_bus(self) -> None:
        import can

        while content := self._far.recv(FRAME.size):
            identifier, size, data = FRAME.unpack(content)
            remote = bool(identifier & REMOTE)
            self._bus.send(
                can.Message(
                    arbitration_id=identifier & STANDARD,
                    data=None if remote else data[:size],
                    is_extended_id=False,
                    is_remote_frame=remote,
                    dlc=8 if remote else size,
                )
            )


if TYPE_CHECKING:
    import can


def python_can_bus(address: Address, bitrate: int) -> "can.BusABC":
    """Open a bus of python-can. Raises DeviceError with its own reason."""
    import can

    more: JsonObject = {"bitrate": bitrate}
    if address.interface == "udp_multicast":
        more = {"hop_limit": 0, "port": int(address.number("port", 43113, 1024, 65535))}
    elif address.interface == "virtual":
        more = {}
    try:
        return can.Bus(interface=address.interface, channel=address.place, **more)
    except (can.CanError, OSError, ValueError, ImportError) as error:
        reason = " ".join(str(error).split())
        raise DeviceError(f"{address.url}: {reason}: check it") from None
