"""A bus of python-can as struct can_frame on a socket: a program of its own, run by `can_bus`.

    python can_bridge.py BUS DESCRIPTOR

BUS: arguments of can.Bus as JSON. The socket gets one empty frame when the bus is open. What fails
is one line on standard output, and the end of the socket. A process of its own, for the frames of
1 kHz must not wait until another thread of Python lets go of the interpreter.
"""

import contextlib
import json
import os
import socket
import struct
import sys
import threading

FRAME = struct.Struct("=IB3x8s")  # struct can_frame
REMOTE, STANDARD = 0x40000000, 0x7FF  # of its identifier: a flag, and the bits of a short one
_RECEIVE_S = 0.1  # how soon a thread that waits for a frame sees that the socket was closed
_PRIORITY = 70  # below the loop's
_SLCAN_OPEN_S = 0.02  # python-can would wait for 2 s


def main(bus_arguments: str, descriptor: str) -> None:
    """Carry frames until one of both ends closes; only data frames with short identifiers come."""
    import can
    from can.interfaces.slcan import slcanBus

    if sys.platform != "linux":  # mypy reads no further there
        raise NotImplementedError
    with contextlib.suppress(OSError):  # not allowed
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_PRIORITY))
    arguments, over = json.loads(bus_arguments), threading.Event()
    if arguments["interface"] == "slcan":
        arguments["sleep_after_open"] = _SLCAN_OPEN_S
    with socket.socket(fileno=int(descriptor)) as near, can.Bus(**arguments) as bus:
        slcan = bus if isinstance(bus, slcanBus) else None
        if slcan is not None:
            slcan.serialPortOrig.flush = lambda: None  # each frame would wait for the adapter
        near.send(FRAME.pack(0, 0, b""))

        def to_bus() -> None:
            """Carry frames from the socket to the bus until either closes."""
            try:
                while content := near.recv(FRAME.size):
                    identifier, size, data = FRAME.unpack(content)
                    remote = bool(identifier & REMOTE)
                    bus.send(
                        can.Message(
                            arbitration_id=identifier & STANDARD,
                            data=None if remote else data[:size],
                            is_extended_id=False,
                            is_remote_frame=remote,
                            dlc=8 if remote else size,
                        )
                    )
            except Exception as error:  # each interface has errors of its own
                fail(error)
            over.set()

        sending = threading.Thread(target=to_bus)
        sending.start()
        while not over.is_set():
            try:
                message = bus.recv(_RECEIVE_S)
            except Exception as error:
                damaged = isinstance(error.__cause__ or error, ValueError | IndexError)
                if slcan is None or not damaged:
                    raise
                slcan.flush()  # python-can would read a damaged line again and again
                continue
            if message is None or message.is_extended_id or message.is_fd:
                continue
            if message.is_error_frame or message.is_remote_frame:
                continue
            frame = FRAME.pack(message.arbitration_id, len(message.data), bytes(message.data))
            with contextlib.suppress(BlockingIOError):  # nobody reads: it is full of samples
                near.send(frame, socket.MSG_DONTWAIT)


def fail(error: Exception) -> None:
    """End the process, and so the socket, with the reason as a line."""
    reason = f"{error} ({error.__cause__})" if error.__cause__ else str(error)
    print(" ".join(reason.split()).rstrip("."), flush=True)
    os._exit(1)


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except Exception as error:
        fail(error)
