"""Force Dimension's SDK, loaded where it is installed: its functions, and what it says in words.

Only its binary interface is used, as CHAI3D's public header declares it; nothing of the SDK is
needed to build or to install springpot.
"""

import os
import re
from collections.abc import Mapping
from enum import IntEnum

import cffi

from springpot.codegen.errors import DeviceError
from springpot.codegen.types import CData

LIBRARY_VARIABLE = "SPRINGPOT_LIBDHD"
UDEV_RULE = 'SUBSYSTEM=="usb", ATTRS{idVendor}=="1451", MODE="0666"'
_NAMES = (
    ("dhd64.dll", "drd64.dll")
    if os.name == "nt"
    else ("libdhd.so.3", "libdhd.so", "libdrd.so.3", "libdrd.so")  # the second holds the first
)
_DECLARATIONS = """
int dhdGetDeviceCount(void);
int dhdOpen(void);
int dhdOpenID(signed char id);
int dhdClose(signed char id);
int dhdGetDeviceID(void);
int dhdGetStatus(int status[], signed char id);
int dhdGetButton(int index, signed char id);
int dhdGetPosition(double *x, double *y, double *z, signed char id);
int dhdGetLinearVelocity(double *x, double *y, double *z, signed char id);
int dhdSetForce(double x, double y, double z, signed char id);
int dhdEnableForce(unsigned char on, signed char id);
int dhdEnableExpertMode(void);
int dhdDisableExpertMode(void);
int dhdSetEffectorMass(double mass, signed char id);
int dhdSetGravityCompensation(int on, signed char id);
int dhdSetMaxForce(double limit, signed char id);
int dhdSetWatchdog(unsigned char duration, signed char id);
int dhdErrorGetLast(void);
const char *dhdErrorGetStr(int error);
"""
# A session can do without the first; without the others it has no watchdog, and says so.
_OPTIONAL = ("dhdSetMaxForce", "dhdSetWatchdog", "dhdEnableExpertMode", "dhdDisableExpertMode")
DHD_ON, DHD_OFF = 1, 0
_STATUS = 32  # more than any version of the SDK fills
_FORCE_OFF = (
    "of itself",
    "by its force button",
    "for it moved too fast",
    "by its watchdog",
    "by software",
    "for USB was cut",
    "by its dead man's switch",
)
_DRIVER, _DEVICE, _BUSY, _IN_USE, _NOT_AVAILABLE = 4, 5, 3, 20, 6  # errors of the SDK


class DhdStatus(IntEnum):
    """Places in a device's status."""

    POWER = 0
    CALIBRATED = 3
    FORCE = 5
    ERROR = 9


class DhdLibrary:
    """The SDK of one library file. ffi: cffi's types. c: its functions."""

    def __init__(self, url: str, file: str | None) -> None:
        """Load `file`, or what the environment names, or what the loader finds.

        Raises DeviceError where there is none, or it lacks a function.
        """
        self.ffi = cffi.FFI()
        self.ffi.cdef(_DECLARATIONS)
        self._url = url
        named = file or os.environ.get(LIBRARY_VARIABLE)
        failures = []
        for name in (named,) if named else _NAMES:
            try:
                self.c: CData = self.ffi.dlopen(name)
                break
            except OSError as error:
                failures.append(str(error).partition(".  Additionally")[0])
        else:
            raise DeviceError(
                f"{url}: Force Dimension's SDK is not found ({failures[0]}): install it from its "
                f"maker and name its libdhd.so by ?library=, by {LIBRARY_VARIABLE}, or in the "
                "loader's path"
            )
        for name in re.findall(r"dhd\w+", _DECLARATIONS):
            if name not in _OPTIONAL and not self.has(name):
                raise DeviceError(f"{url}: this SDK has no {name}: install version 3.3.2 or newer")

    def has(self, name: str) -> bool:
        try:
            getattr(self.c, name)
        except AttributeError:
            return False
        return True

    def words(self, error: int | None = None) -> str:
        """Return the SDK's own words for an error; of the calling thread's last one by default."""
        number = self.c.dhdErrorGetLast() if error is None else error
        return str(self.ffi.string(self.c.dhdErrorGetStr(number)).decode(errors="replace"))

    def status(self, device: int) -> list[int]:
        """Return the status vector. Raises DeviceError where the device does not give it."""
        status = self.ffi.new("int[]", _STATUS)
        if self.c.dhdGetStatus(status, device) < 0:
            raise self.error("gives no status", "check cable and power")
        return list(status)

    def open(self, number: int | None) -> int:
        """Open a device by its number, or the first; return the SDK's handle.

        Raises DeviceError with the cause and what to do.
        """
        count = self.c.dhdGetDeviceCount()
        if count <= 0:
            raise DeviceError(
                f"{self._url}: no Force Dimension device on USB that this user may open: check "
                f"cable and power; {_ALLOW}; end other programs that hold one; in a container, "
                "pass it on"
            )
        if number is not None and number >= count:
            raise DeviceError(
                f"{self._url}: there is no device {number}: {count} found, counted from 0"
            )
        device: int = self.c.dhdOpen() if number is None else self.c.dhdOpenID(number)
        if device < 0:
            raise self.error("cannot be opened", _REMEDIES.get(self.c.dhdErrorGetLast(), _UNKNOWN))
        return device if number is not None else self.c.dhdGetDeviceID()

    def error(self, what: str, remedy: str) -> DeviceError:
        """Return an error with the SDK's words for the last one."""
        return DeviceError(f"{self._url}: {what} ({self.words()}): {remedy}")


_UNKNOWN = "check cable and power, then try the maker's HapticDesk"
_ALLOW = (
    f"allow it: write `{UDEV_RULE}` to /etc/udev/rules.d/60-forcedimension.rules, then "
    "`sudo udevadm control --reload && sudo udevadm trigger`"
)
_HELD = "another program holds it: end that one"
_REMEDIES: Mapping[int, str] = {
    **dict.fromkeys((_BUSY, _IN_USE, _NOT_AVAILABLE), _HELD),
    _DRIVER: _ALLOW,
    _DEVICE: "check cable and power",
}


def force_off_words(cause: int) -> str:
    """Say why a device switched its forces off, from the SDK's number of the cause."""
    return _FORCE_OFF[cause] if 0 <= cause < len(_FORCE_OFF) else f"for cause {cause}"
