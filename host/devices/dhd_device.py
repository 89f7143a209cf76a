"""A Force Dimension device (dhd://): opened, checked, armed; then the loop calls it."""

import contextlib
import math
import time

from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.types import CData
from springpot.host.devices.device import (
    FORCE_ZERO,
    ZERO_S,
    DeviceRequirements,
    OpenedDevice,
    require_sample_rate,
)
from springpot.host.devices.dhd import DHD_OFF, DHD_ON, DhdLibrary, DhdStatus, force_off_words
from springpot.host.devices.drivers import Address

_KEYS = ("library", "axis", "surface_mm", "walls_npm", "watchdog", "effector_mass_kg", "weight_n")
# Index of the axis, and its sign: along it the tool goes into the object; the first by default.
_AXES = {f"{sign}{name}": (axis, -1.0 if sign else 1.0)
         for name, axis in (("z", 2), ("x", 0), ("y", 1)) for sign in ("-", "")}  # fmt: skip
_LINKED = {
    "get_position": "dhdGetPosition",
    "get_linear_velocity": "dhdGetLinearVelocity",
    "set_force": "dhdSetForce",
    "get_status": "dhdGetStatus",
    "get_button": "dhdGetButton",
    "enable_force": "dhdEnableForce",
    "error_get_last": "dhdErrorGetLast",
}
_WATCHDOG_STEP_S, _MAX_STEPS = 125e-6, 255  # of the SDK
_LOOK_S = 0.0005
_STAYS = "its last force may still act, for watchdog=off: press its force button"
_MAX_WALL_NPM = 5000.0
_GRAVITY_N = 5.0  # room for its gravity compensation, should the SDK's limit hold that too


class DhdDevice(OpenedDevice):
    """One device, its tool on a line along one axis; forces on, none given yet."""

    rate_advice = (
        "end other programs, plug it into a port of its own, or render a scene of its rate "
        "([runtime] rate_hz, where the model allows it)"
    )

    def __init__(self, address: Address, requirements: DeviceRequirements) -> None:
        """Open and arm it. Raises UsageError for a wrong URL, DeviceError with one line else."""
        address.require_known(_KEYS)
        self._url, self._address, self._required = address.url, address, requirements
        self._axis, self._sign = _AXES[address.choice("axis", tuple(_AXES))]
        self._walls_npm = address.number("walls_npm", 0.0, 0.0, _MAX_WALL_NPM)
        if self._watched and requirements.rate_hz * _WATCHDOG_STEP_S * _MAX_STEPS < 2:
            raise UsageError(
                f"{self._url}: its watchdog waits {1e3 * _WATCHDOG_STEP_S * _MAX_STEPS:.0f} ms at "
                "most, which needs at least 63 Hz: raise runtime.rate_hz"
            )
        if address.place and not address.place.isdecimal():
            raise UsageError(f"{address.url}: {address.place!r} is no device's number: use dhd://0")
        self._sdk = DhdLibrary(address.url, address.settings.get("library"))
        self._link: CData = None
        self._owners: list[CData] = []
        self.id = self._sdk.open(int(address.place) if address.place else None)
        try:
            self._require_usable()
            self._set_up()
            self._prove_watchdog()
            require_sample_rate(
                address.url, requirements.rate_hz, self._positions_until, self.rate_advice
            )
        except BaseException:
            self.stop()
            self.close()
            raise

    @property
    def failure(self) -> str:
        """Reason why the device is gone or has switched its forces off."""
        error = 0 if self._link is None else int(self._link.device_error)
        c = self._owners[0].c if self._owners else None
        if not error or c is None:
            return ""
        if error >= c.SP_DHD_FORCE_OFF:
            return f"it switched its forces off {force_off_words(error - c.SP_DHD_FORCE_OFF)}"
        if error >= c.SP_DHD_SLOW_CALL:
            ms = 1e3 * self._required.watchdog_s
            return f"a call of its SDK took more than {ms:g} ms, in which the last force stayed"
        return self._sdk.words(error)

    def link(self, library: CLibrary) -> CData:
        """Make the link by which the loop in C calls the SDK: its functions, axis and limits."""
        ffi, sdk = library.ffi, self._sdk
        address = self._address
        members = dict(ffi.typeof("sp_dhd").fields)
        functions = {
            member: ffi.cast(
                members[member].type, int(sdk.ffi.cast("uintptr_t", sdk.ffi.addressof(sdk.c, name)))
            )
            for member, name in _LINKED.items()
        }
        required, place = self._required, ffi.new("double[3]")
        if self._sdk.c.dhdGetPosition(place, place + 1, place + 2, self.id) < 0:
            raise self._sdk.error("gives no position", "check cable and power")
        settings = ffi.new(
            "sp_dhd *",
            {
                **functions,
                "id": self.id,
                "axis": self._axis,
                "sign": self._sign,
                "surface_m": address.number("surface_mm", 1e3 * required.surface_m, -1e3, 1e3)
                / 1e3,
                "line_m": list(place),
                "wall_npm": self._walls_npm,
                "max_n": required.max_n,
                "weight_n": self._weight_n,
                "max_call_s": required.watchdog_s,
            },
        )
        memory = library.memory(library.c.sp_link_dhd_size())
        self._owners = [library, memory, settings]
        self._link = library.c.sp_link_dhd_init(memory, settings)
        return self._link

    def stop(self) -> None:
        self._sdk.c.dhdSetForce(0.0, 0.0, 0.0, self.id)
        self._sdk.c.dhdEnableForce(DHD_OFF, self.id)

    @property
    def unreached(self) -> str:
        """Say what the device's force does once this host cannot reach it."""
        return FORCE_ZERO if self._watched else _STAYS

    def close(self) -> None:
        self.stop()  # what went away may have kept its last force
        self._sdk.c.dhdClose(self.id)

    @property
    def _weight_n(self) -> float:
        weight_n = self._address.number("weight_n", self._required.weight_n, -20.0, 20.0)
        return 0.0 if self._required.examined else weight_n  # nobody may hold the handle up

    def _require_usable(self) -> None:
        """Raise DeviceError for a device that is off, faulty or uncalibrated, or a button down."""
        status = self._sdk.status(self.id)
        if not status[DhdStatus.POWER]:
            raise DeviceError(f"{self._url}: it has no power: switch it on")
        if status[DhdStatus.ERROR]:
            raise DeviceError(
                f"{self._url}: it reports an error of its own: switch it off and on, then try the "
                "maker's HapticDesk"
            )
        if not status[DhdStatus.CALIBRATED]:
            raise DeviceError(
                f"{self._url}: it is not calibrated: put its pole into the pit until the LED is "
                "steady (a Falcon to all its stops), or run the maker's HapticInit"
            )
        if self._sdk.c.dhdGetButton(0, self.id) > 0:
            raise DeviceError(f"{self._url}: its button is pressed, which stops: release it")

    def _set_up(self) -> None:
        """Set gravity, limit of force and watchdog; then switch the forces on, at zero."""
        required, sdk = self._required, self._sdk
        stated_kg = math.nan if required.effector_mass_kg is None else required.effector_mass_kg
        mass_kg = self._address.number("effector_mass_kg", stated_kg, 0.0, 5.0)
        if not math.isnan(mass_kg):  # else the device's own
            self._call("dhdSetEffectorMass", mass_kg)
        self._call("dhdSetGravityCompensation", DHD_ON)
        if sdk.has("dhdSetMaxForce"):
            walls = 2 if self._walls_npm else 0
            limit_n = math.hypot(required.max_n, *[required.max_n] * walls) + abs(self._weight_n)
            self._call("dhdSetMaxForce", limit_n + _GRAVITY_N)
        if self._watched:
            self._set_watchdog()
        self._enable_force()

    @property
    def _watched(self) -> bool:
        return self._address.choice("watchdog", ("on", "off")) == "on"

    def _set_watchdog(self) -> None:
        """Set the device's own watchdog, which ends its force where the host is silent.

        It is among the SDK's functions for experts, which are closed else.
        """
        sdk = self._sdk
        for name in ("dhdSetWatchdog", "dhdEnableExpertMode", "dhdDisableExpertMode"):
            if not sdk.has(name):
                raise self._unwatched(f"this SDK has no {name}")
        if sdk.c.dhdEnableExpertMode() < 0:
            raise sdk.error("dhdEnableExpertMode failed", "install a newer SDK")
        steps = math.ceil(self._required.watchdog_s / _WATCHDOG_STEP_S - 1e-9)
        is_set = sdk.c.dhdSetWatchdog(min(steps, _MAX_STEPS), self.id) >= 0
        why = "" if is_set else sdk.words()
        sdk.c.dhdDisableExpertMode()
        if not is_set:
            raise self._unwatched(f"the device has no watchdog ({why})")

    def _enable_force(self) -> None:
        """Switch the forces on, at zero. Raises DeviceError if they stay off."""
        self._call("dhdSetForce", 0.0, 0.0, 0.0)
        self._call("dhdEnableForce", DHD_ON)
        if not self._sdk.status(self.id)[DhdStatus.FORCE]:
            raise DeviceError(
                f"{self._url}: its forces stay off: press its force button, or hold its handle "
                "where it has a dead man's switch"
            )

    def _call(self, name: str, *arguments: float) -> None:
        if getattr(self._sdk.c, name)(*arguments, self.id) < 0:
            raise self._sdk.error(f"{name} failed", "check cable and power")

    def _unwatched(self, why: str) -> DeviceError:
        return DeviceError(
            f"{self._url}: {why}: were this program killed, the device would keep its last force. "
            "With ?watchdog=off you accept that: keep a finger at its force button"
        )

    def _prove_watchdog(self) -> None:
        """Prove the watchdog: after a force of zero and silence, they must go off and on."""
        if not self._watched:
            return
        self._call("dhdSetForce", 0.0, 0.0, 0.0)
        begin_s = time.perf_counter()
        while self._sdk.status(self.id)[DhdStatus.FORCE]:
            if time.perf_counter() > begin_s + ZERO_S:
                raise self._unwatched(
                    f"without forces from here its own stay on for more than {ZERO_S:g} s"
                )
            time.sleep(_LOOK_S)
        self._enable_force()

    def _positions_until(self, until_s: float) -> int:
        """Count new positions; forces of zero keep the device's watchdog quiet."""
        place, count = self._sdk.ffi.new("double[3]"), 0
        period_s = 0.5 / self._required.rate_hz
        while time.perf_counter() < until_s:
            count += self._sdk.c.dhdGetPosition(place, place + 1, place + 2, self.id) == 0
            with contextlib.suppress(DeviceError):
                self._call("dhdSetForce", 0.0, 0.0, 0.0)
            time.sleep(period_s)
        return count
