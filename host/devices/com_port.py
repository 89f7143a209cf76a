"""A COM port of Windows whose reads return what is there at once.

pyserial's handle is overlapped, which the C end of a link cannot share.
"""

import sys

assert sys.platform == "win32"  # mypy and other systems read no further

import ctypes
from ctypes import wintypes

_READ_WRITE, _OPEN_EXISTING = 0xC0000000, 3
_RETURN_AT_ONCE = 0xFFFFFFFF  # of SetCommTimeouts' read interval
_WRITE_MS = 1

_kernel = ctypes.WinDLL("kernel32", use_last_error=True)
_kernel.CreateFileW.restype = wintypes.HANDLE
_kernel.CreateFileW.argtypes = [
    wintypes.LPCWSTR, wintypes.DWORD, wintypes.DWORD, wintypes.LPVOID, wintypes.DWORD,
    wintypes.DWORD, wintypes.HANDLE,
]  # fmt: skip


def _require(succeeded: int) -> None:
    if not succeeded:
        raise ctypes.WinError(ctypes.get_last_error())


class ComPort:
    """The part of pyserial's Serial that a link needs. fd: the handle. Raises OSError."""

    def __init__(self, place: str, baud: int) -> None:
        """Open the port for one process, set its rate, and let reads return at once."""
        self.fd = _kernel.CreateFileW(
            f"\\\\.\\{place}", _READ_WRITE, 0, None, _OPEN_EXISTING, 0, None
        )
        _require(self.fd not in (None, wintypes.HANDLE(-1).value))
        self._handle = wintypes.HANDLE(self.fd)
        settings = (ctypes.c_ubyte * 28)()  # DCB, which begins with its own size
        settings[0] = len(settings)
        mode = f"baud={baud} parity=N data=8 stop=1 dtr=on rts=on"
        _require(_kernel.BuildCommDCBW(mode, settings))
        _require(_kernel.SetCommState(self._handle, settings))
        timeouts = (wintypes.DWORD * 5)(_RETURN_AT_ONCE, 0, 0, 0, _WRITE_MS)
        _require(_kernel.SetCommTimeouts(self._handle, timeouts))

    def read(self, size: int) -> bytes:
        """Read up to `size` bytes of those that have come."""
        room, count = ctypes.create_string_buffer(size), wintypes.DWORD()
        _require(_kernel.ReadFile(self._handle, room, size, ctypes.byref(count), None))
        return room.raw[: count.value]

    def write(self, content: bytes) -> int:
        """Write, and return how many bytes fitted."""
        count = wintypes.DWORD()
        _require(_kernel.WriteFile(self._handle, content, len(content), ctypes.byref(count), None))
        return count.value

    def close(self) -> None:
        """Close the handle."""
        _kernel.CloseHandle(self._handle)
